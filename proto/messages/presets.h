#pragma once

#include <array>
#include <span>
#include <string_view>

#include "proto/messages/json.h"
#include "proto/messages/object_reader.h"

namespace fairway {

/// Sets of defaults for a kind of mesh.
enum class Preset { automatic, cad, organic, scan, gentle };

/// All of them.
inline constexpr std::array kPresets = {Preset::automatic, Preset::cad, Preset::organic,
                                        Preset::scan, Preset::gentle};

/// "auto", "cad", "organic", "scan", "gentle".
std::span<const Named<Preset>> preset_names();
std::string_view name_of(Preset preset);

/// What it is for, in a sentence or two.
std::string_view description_of(Preset preset);

/// Its values, as a parameter document.
Json values_of(Preset preset);

/// Adds the values of the preset that a parameter document names to what the document states;
/// objects are filled member by member. What only the variational method uses is left out where a
/// flow is stated. Nothing, where no preset is named.
void fill_from_preset(Json& document);

}  // namespace fairway
