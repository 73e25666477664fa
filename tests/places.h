#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace fairway::test {

/// Path of a program of this build: "fairway", "fairwayd", "fairway-submit".
std::string program(std::string_view name);

/// Path of a library of this build that tests preload into programs.
std::string preloaded(std::string_view name);

/// Path inside the source tree.
std::filesystem::path source(std::string_view path);

/// Path inside the shared data (FAIRWAY_SHARED, or `shared` beside the checkout); nothing, said
/// plainly, where it is absent.
std::optional<std::filesystem::path> shared(std::string_view path);

}  // namespace fairway::test
