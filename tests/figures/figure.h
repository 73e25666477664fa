#pragma once

#include <string>
#include <vector>

#include "core/mesh.h"
#include "tests/figures/rasteriser.h"

namespace fairway {

/// What the colours of a panel say: values from 0 to `most`; larger ones look like `most`.
struct Scale {
  double most = 1.0;
  std::string title;
  bool operator==(const Scale&) const = default;
};

/// One picture of a mesh in a figure.
struct Panel {
  std::string title;
  std::string note;  ///< what was measured
  IndexedMesh mesh;
  std::vector<double> values;  ///< per vertex
  Scale scale;
  std::vector<Vec3> line;  ///< drawn over it, such as a boundary; may be empty
};

/// Panels side by side, seen by one camera, so that sizes compare.
struct Figure {
  std::string name;     ///< of its file
  std::string caption;  ///< what to see, and every choice that was made; may be empty
  std::vector<Panel> panels;
  Camera camera;
  int panel_width = 420;
  int panel_height = 400;
  int text_scale = 2;
  bool bare =
      false;  ///< titles only: no letters, notes or legend, and fewer colours, so a small file
};

/// A camera that shows the whole mesh in panels of that shape with a little room around.
Camera camera_for(const IndexedMesh& mesh, const Vec3& direction, const Vec3& up,
                  double width_by_height);

/// A panel's picture alone, without any text.
Image picture(const Figure& figure, const Panel& panel);

/// The picture: panels with title and note below them, a legend wherever the scale changes.
Image compose(const Figure& figure);

/// Caption and measured values as Markdown.
std::string markdown(const Figure& figure);

}  // namespace fairway
