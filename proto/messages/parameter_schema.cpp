// The schema of the parameters with its texts. Names, ranges and defaults come from the readers.

#include "proto/messages/parameter_schema.h"

#include <array>
#include <string>

#include "proto/messages/parameters.h"

namespace fairway {
namespace {

constexpr std::string_view kDegrees = "degrees";
constexpr std::string_view kLength = "length, in local units of the mesh";
constexpr std::string_view kCurvature = "1/length";
constexpr std::string_view kBits = "bits";

constexpr auto kTexts = std::to_array<ParameterText>({
    {"preset", "", "Whose values the parameters have that are not stated; see presets."},
    {"method", "",
     "How the surface is denoised; see methods. Where a parameter of the flows is stated and no "
     "method, anisotropic_prescribed."},
    {"strength", "",
     "Variational method: how far along its path. 0 leaves the surface as it is, 1 is the end. "
     "auto: where cross-validation says that the noise is gone and the shape is not."},
    {"noise", "",
     "Variational method: white, of each vertex by itself, or correlated, of neighbours alike. "
     "auto: looks."},
    {"surface", "",
     "Variational method: sharp tries no low pass, smooth makes no crease below 8 degrees."},
    {"integration", "",
     "Flows; explicit: cheap steps. semi_implicit: one linear system a step, which allows large "
     "ones."},
    {"mass", "", "Mass matrix. auto: lumped for explicit steps, full for semi-implicit ones."},
    {"curvature_measure", "",
     "How prescribed flows find the curvature f: |H|/|V|, the projection of H on V, or the mass "
     "matrix."},
    {"steps", "steps",
     "Flows: how many steps. auto: until the noise that was found is removed, at most 100; none "
     "where "
     "there is none."},
    {"step_size", "squared mean edge lengths", "Time step tau of one step. auto: 0.1."},
    {"feature_angle", kDegrees,
     "Edges bent by more are features: flows keep them sharp, and features marks their ends. auto: "
     "three deviations of the noise, from 12 to 30, anew in every step. Not together with "
     "lambda."},
    {"lambda", kLength,
     "The same threshold as the edge curvature 2 L sin(angle / 2), L being the mean edge length. "
     "Not together with feature_angle."},
    {"transition", "",
     "r of the weight w(lambda, r): the larger, the less an edge beyond the threshold counts."},
    {"curvature_smoothing", "", "Smoothing of the curvature that prescribed flows aim at."},
    {"curvature_smoothing/passes", "passes", "How often it is averaged over the neighbours."},
    {"curvature_smoothing/fraction", "", "Share of the average in each pass."},
    {"boundary", "", "fixed: vertices at open boundaries do not move."},
    {"conventions", "",
     "recommended: feature vertices average over feature neighbours only. paper: the text of the "
     "paper literally."},
    {"guards", "", "What keeps runs from harm beside the plain formulas."},
    {"guards/unfold", "", "Relax edges bent by more than 120 degrees before the first step."},
    {"guards/min_component", "vertices",
     "Smaller groups of strong edges are noise, not features. false or 0: none is."},
    {"guards/local_step", "", "Shorten the step of vertices where the common one is unstable."},
    {"fixed_vertices", "",
     "Vertices that come back bit for bit, with all at the same place: indices, from 0, in the "
     "only POSITION accessor of the file, or lists by mesh and primitive. 100000 at most, all "
     "lists together."},
    {"fixed_vertices/mesh", "", "Index of a mesh in the glTF."},
    {"fixed_vertices/primitive", "", "Index of a triangle primitive in the mesh."},
    {"fixed_vertices/vertices", "", "Indices in the POSITION accessor of the primitive."},
    {"meshes", "", "Indices of glTF meshes: only these, and those of nodes, are touched."},
    {"nodes", "", "Indices of glTF nodes: only their meshes, and those of meshes, are touched."},
    {"weld", "",
     "position: vertices at equal positions are one. none: each index is a vertex of its own."},
    {"curvature", "", "Attributes of the result; names of the glTF attributes are taken too."},
    {"curvature_space", "",
     "world: lengths of the scene, where a mesh has one uniform scale there."},
    {"colors", "", "Vertex colours of the predominant curvature: true, or their settings."},
    {"colors/limit", kCurvature,
     "Curvature of the last colours of the map. auto: what 95 % of the vertices stay below."},
    {"colors/replace", "", "Also where the file has colours."},
    {"features", "", "Mark feature vertices with the attribute _FEATURE."},
    {"output", "", "Format of the result. auto: that of the input."},
    {"output/format", "", "Format of the result. auto: that of the input."},
    {"compression", "", "Of glTF out. meshopt is lossless; keep: each primitive as it came."},
    {"draco", "", "How meshes are written with Draco. 0 bits keep floats as they are."},
    {"draco/position_bits", kBits, "Of the largest extent of the mesh."},
    {"draco/normal_bits", kBits, "Of an octahedral coordinate."},
    {"draco/texcoord_bits", kBits, "Of the larger extent of the coordinates."},
    {"draco/curvature_bits", kBits, "Of the range of an attribute's values."},
    {"draco/level", "", "0 is fast, 10 small."},
    {"draco/keep_order", "", "false: vertices and triangles may be reordered, which is smaller."},
});

/// The schema at the property `name` of an object, of the objects of a list, or of an alternative.
Json* property_of(Json& schema, const std::string& name) {
  if (auto properties = schema.find("properties"); properties != schema.end()) {
    if (auto found = properties->find(name); found != properties->end()) return &*found;
  }
  if (auto items = schema.find("items"); items != schema.end()) return property_of(*items, name);
  if (auto alternatives = schema.find("anyOf"); alternatives != schema.end()) {
    for (Json& alternative : *alternatives) {
      if (Json* found = property_of(alternative, name)) return found;
    }
  }
  return nullptr;
}

Json* place_of(Json& schema, std::string_view path) {
  Json* at = &schema;
  while (at != nullptr && !path.empty()) {
    const std::size_t end = path.find('/');
    at = property_of(*at, std::string(path.substr(0, end)));
    path = end == std::string_view::npos ? std::string_view() : path.substr(end + 1);
  }
  return at;
}

}  // namespace

std::span<const ParameterText> parameter_texts() {
  return kTexts;
}

const Json* schema_of(const Json& schema, std::string_view path) {
  return place_of(const_cast<Json&>(schema), path);  // NOLINT: nothing is written
}

Json parameter_schema() {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "Parameters of a denoising job"}};
  schema.update(bare_parameter_schema());
  for (const ParameterText& text : kTexts) {
    Json* place = place_of(schema, text.path);
    if (place == nullptr) continue;  // a test holds the table and the readers together
    (*place)["description"] = text.text;
    if (!text.unit.empty()) (*place)["x-unit"] = text.unit;
  }
  return schema;
}

}  // namespace fairway
