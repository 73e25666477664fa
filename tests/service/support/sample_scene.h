#pragma once

#include <string>
#include <utility>
#include <vector>

#include "proto/messages/json.h"

namespace fairway::test {

/// A part of a form, as it is sent.
struct FormPart {
  std::string name;
  std::string file_name;
  std::string content;
};

inline const std::string kFormType = "multipart/form-data; boundary=an-edge";

/// The body of a form of type kFormType. Names are written as they are.
std::string form_body(const std::vector<FormPart>& parts);

/// A noisy torus as a .gltf whose buffer and image are files.
struct SampleScene {
  explicit SampleScene(int size = 20);

  Json json;
  std::string bin;  ///< "scene data\u00E4.bin", named with percent escapes
  std::string png = "\x89PNG\r\n\x1a\n and more";  ///< "skins/a.png"

  std::string gltf() const { return json.dump(); }
  /// Names by part name and by file name, the files' own names.
  std::vector<FormPart> parts(const std::string& parameters) const;

  static inline const std::string kBin = "scene data\xC3\xA4.bin";
  static inline const std::string kPng = "skins/a.png";
};

/// What `fairway denoise` makes of the scene in a folder, as the file OUT named `out`.
std::string denoised_by_tool(const SampleScene& scene, const std::string& out,
                             const std::string& parameters);

}  // namespace fairway::test
