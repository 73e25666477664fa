// Makes a C++ source of a file, at build time: embed FILE SOURCE NAME. A .yaml file becomes JSON on
// the way (YAML 1.2, core schema; keys are text). The program that is built has
// `extern const std::string_view fairway::NAME`.

#include <charconv>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

namespace {

using Json = nlohmann::ordered_json;

template <class Number>
bool reads_as(std::string_view text, Number& number) {
  const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  return status == std::errc() && stop == text.data() + text.size();
}

/// A scalar without quotes is null, a truth value or a number where it looks like one.
Json plain_scalar(const std::string& text) {
  if (text == "null" || text == "~" || text.empty()) return nullptr;
  if (text == "true") return true;
  if (text == "false") return false;
  long long whole = 0;
  if (reads_as(text, whole)) return whole;
  double number = 0.0;
  const bool looks_like_number = text.find_first_not_of("+-.0123456789eE") == std::string::npos;
  if (looks_like_number && reads_as(text, number)) return number;
  return text;
}

Json json_of(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return node.Tag() == "!" ? Json(node.Scalar()) : plain_scalar(node.Scalar());
    case YAML::NodeType::Sequence: {
      Json list = Json::array();
      for (const YAML::Node& item : node) list.push_back(json_of(item));
      return list;
    }
    case YAML::NodeType::Map: {
      Json object = Json::object();
      for (const auto& entry : node) {
        const std::string& key = entry.first.Scalar();
        if (object.contains(key)) throw std::runtime_error("the key " + key + " stands twice");
        object[key] = json_of(entry.second);
      }
      return object;
    }
    default:
      return nullptr;
  }
}

std::string contents_of(const std::string& file) {
  if (file.ends_with(".yaml")) return json_of(YAML::LoadFile(file)).dump();
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_source(const std::string& bytes, const std::string& source, const std::string& name) {
  std::ofstream out(source);
  out << "#include <string_view>\n\nnamespace fairway {\nnamespace {\n\n"
      << "constexpr char kBytes[] = {";
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    out << (i % 20 == 0 ? "\n" : " ") << static_cast<int>(static_cast<signed char>(bytes[i]))
        << ',';
  }
  out << "\n};\n\n}  // namespace\n\n"
      << "extern const std::string_view " << name << ";\n"
      << "const std::string_view " << name
      << "(kBytes, sizeof kBytes);\n\n}  // namespace fairway\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + source);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) {
    std::fprintf(stderr, "usage: embed FILE SOURCE NAME\n");
    return 2;
  }
  try {
    write_source(contents_of(arguments[1]), arguments[2], arguments[3]);
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "embed: %s: %s\n", arguments[1], e.what());
    return 1;
  }
}
