// Values for kinds of meshes.

#include "proto/messages/presets.h"

#include <array>
#include <string>
#include <utility>

#include "proto/messages/flow_parameters.h"

namespace fairway {
namespace {

constexpr std::array<Named<Preset>, 5> kNames = {{
    {"auto", Preset::automatic},
    {"cad", Preset::cad},
    {"organic", Preset::organic},
    {"scan", Preset::scan},
    {"gentle", Preset::gentle},
}};

/// Puts what `more` has into `document`, where that does not state it.
void fill(Json& document, const Json& more) {
  for (const auto& [key, value] : more.items()) {
    if (!document.contains(key)) {
      document[key] = value;
    } else if (value.is_object() && document[key].is_object()) {
      for (const auto& [member, inner] : value.items()) {
        if (!document[key].contains(member)) document[key][member] = inner;
      }
    }
  }
}

}  // namespace

std::span<const Named<Preset>> preset_names() {
  return kNames;
}

std::string_view name_of(Preset preset) {
  return kNames[static_cast<std::size_t>(preset)].name;
}

std::string_view description_of(Preset preset) {
  switch (preset) {
    case Preset::automatic:
      return "Every choice is made from the noise and the surface that are found; safe for any "
             "mesh.";
    case Preset::cad:
      return "Parts with flat and curved faces between sharp edges: no low pass is tried, which "
             "would round them.";
    case Preset::organic:
      return "Bodies, faces, statues: no crease below 8 degrees is made, where noise would look "
             "like one.";
    case Preset::scan:
      return "Surfaces from a scanner: the noise is taken for one that neighbours share, whether "
             "it looks like that or not.";
    case Preset::gentle:
      return "A quarter of the path whatever the noise: removes the finest of it and leaves more "
             "than an automatic run does.";
  }
  return {};
}

Json values_of(Preset preset) {
  switch (preset) {
    case Preset::automatic:
      return Json::object();
    case Preset::cad:
      return {{"surface", "sharp"}};
    case Preset::organic:
      return {{"surface", "smooth"}};
    case Preset::scan:
      return {{"noise", "correlated"}};
    case Preset::gentle:
      return {{"strength", 0.25}};
  }
  return Json::object();
}

void fill_from_preset(Json& document) {
  const auto stated = document.find("preset");
  if (stated == document.end() || !stated->is_string()) return;
  const std::string name = *stated;
  for (const Named<Preset>& named : kNames) {
    if (name != named.name) continue;
    Json values = values_of(named.value);
    if (states_flow(document)) drop_variational(values);
    return fill(document, values);
  }
}

}  // namespace fairway
