// Values for kinds of meshes. Those of cad, organic and scan were chosen by the error of the face
// normals on noisy models of their kind.

#include "proto/messages/presets.h"

#include <array>
#include <string>
#include <utility>

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
      return "Every choice is made from the noise that is found; safe for any mesh.";
    case Preset::cad:
      return "Parts with flat and curved faces between sharp edges: a low feature angle that "
             "stays, "
             "with a soft threshold, and a smoother curvature to aim at. Pays from about 0.2 mean "
             "edge lengths of noise on.";
    case Preset::organic:
      return "Bodies, faces, statues: keeps relief and creases without making flat patches and "
             "edges of them; the volume may change by a percent.";
    case Preset::scan:
      return "Open surfaces with strong noise from a scanner: boundaries stay in place, and small "
             "groups of bent edges count as noise, not as features.";
    case Preset::gentle:
      return "Five small steps whatever the noise: removes the finest of it and moves vertices by "
             "a fraction of what an automatic run does.";
  }
  return {};
}

Json values_of(Preset preset) {
  switch (preset) {
    case Preset::automatic:
      return Json::object();
    case Preset::cad:
      return {{"method", "anisotropic_prescribed"},
              {"feature_angle", 16},
              {"transition", 2},
              {"curvature_smoothing", {{"passes", 2}}}};
    case Preset::organic:
      return {{"method", "anisotropic"}, {"transition", 2}};
    case Preset::scan:
      return {{"method", "anisotropic"},
              {"feature_angle", 30},
              {"boundary", "fixed"},
              {"guards", {{"min_component", 40}}}};
    case Preset::gentle:
      return {{"method", "anisotropic_prescribed"}, {"steps", 5}, {"step_size", 0.05}};
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
    if (document.contains("feature_angle") || document.contains("lambda")) {
      values.erase("feature_angle");
      values.erase("lambda");
    }
    return fill(document, values);
  }
}

}  // namespace fairway
