#include "tests/bench/draco_baseline.h"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>

namespace fairway::bench {
namespace {

std::unique_ptr<draco::Mesh> decode(std::span<const std::byte> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  return decoder.DecodeMeshFromBuffer(&buffer).value();
}

}  // namespace

struct DracoBaseline::State {
  std::span<const std::byte> input;
  std::unique_ptr<draco::Mesh> result;
  DracoOptions options;

  State(std::span<const std::byte> in, std::unique_ptr<draco::Mesh> mesh, const DracoOptions& how)
      : input(in), result(std::move(mesh)), options(how) {}
};

DracoBaseline::DracoBaseline(std::span<const std::byte> input, std::span<const std::byte> result,
                             const DracoOptions& options)
    : state_(std::make_unique<State>(input, decode(result), options)) {}

DracoBaseline::~DracoBaseline() = default;

std::size_t DracoBaseline::run() const {
  const std::unique_ptr<draco::Mesh> mesh = decode(state_->input);
  const DracoOptions& options = state_->options;
  draco::Encoder encoder;
  encoder.SetSpeedOptions(10 - options.level, 10 - options.level);
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, options.position_bits);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::GENERIC, options.curvature_bits);
  draco::EncoderBuffer buffer;
  return encoder.EncodeMeshToBuffer(*state_->result, &buffer).ok() ? buffer.size() : 0;
}

}  // namespace fairway::bench
