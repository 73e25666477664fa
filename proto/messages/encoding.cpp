// How results are written, as a part of the parameter document.

#include "proto/messages/encoding.h"

#include <algorithm>
#include <array>

namespace fairway {
namespace {

/// What Draco's quantisation takes.
constexpr int kMostBits = 30;

constexpr std::array<Named<Compression>, 4> kCompressions = {{
    {"none", Compression::none},
    {"draco", Compression::draco},
    {"meshopt", Compression::meshopt},
    {"keep", Compression::keep},
}};

}  // namespace

Encoding read_encoding(ObjectReader& reader) {
  Encoding encoding;
  reader.choice("compression", std::span<const Named<Compression>>(kCompressions),
                encoding.compression);
  DracoOptions& draco = encoding.draco;
  ObjectReader child = reader.object("draco");
  child.integer("position_bits", 0, kMostBits, draco.position_bits);
  child.integer_or_zero("normal_bits", 2, kMostBits, draco.normal_bits);
  child.integer("texcoord_bits", 0, kMostBits, draco.texcoord_bits);
  child.integer("curvature_bits", 0, kMostBits, draco.curvature_bits);
  child.integer("level", 0, 10, draco.level);
  child.boolean("keep_order", draco.keep_order);
  reader.take_error(child);
  return encoding;
}

void add_encoding(const Encoding& encoding, Json& document) {
  const DracoOptions& draco = encoding.draco;
  document["compression"] = std::find_if(kCompressions.begin(), kCompressions.end(),
                                         [&](const Named<Compression>& named) {
                                           return named.value == encoding.compression;
                                         })
                                ->name;
  document["draco"] = {{"position_bits", draco.position_bits},
                       {"normal_bits", draco.normal_bits},
                       {"texcoord_bits", draco.texcoord_bits},
                       {"curvature_bits", draco.curvature_bits},
                       {"level", draco.level},
                       {"keep_order", draco.keep_order}};
}

}  // namespace fairway
