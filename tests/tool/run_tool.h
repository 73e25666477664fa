#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "tests/formats/sample_glb.h"

namespace fairway::test {

/// How a run of the fairway program ended.
struct ToolRun {
  int exit_code = 0;   ///< −1 if a signal ended it
  std::string output;  ///< standard output and error together
};

/// Runs build/…/bin/fairway with these arguments and waits for its end.
ToolRun run_tool(const std::vector<std::string>& arguments);

Bytes read_bytes(const std::filesystem::path& path);
void write_bytes(const std::filesystem::path& path, const Bytes& bytes);

/// A GLB with one primitive: float32 positions and indices.
Bytes glb_of(const IndexedMesh& mesh);

/// The triangle list that a file holds, all surfaces together.
IndexedMesh mesh_of(const std::filesystem::path& path, Format format = Format::glb);

}  // namespace fairway::test
