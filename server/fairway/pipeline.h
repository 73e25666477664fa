#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/result.h"
#include "proto/formats/byte_chain.h"
#include "proto/formats/side_files.h"
#include "proto/messages/format.h"
#include "proto/messages/parameters.h"
#include "proto/messages/report.h"
#include "proto/messages/worker_protocol.h"

namespace fairway {

/// A denoised file. Its bytes refer to the input and the side files.
struct PipelineOutput {
  ByteChain bytes;
  Format format = Format::glb;
  JobReport report;
};

/// Called at the start of each stage and after each step of a flow.
using ProgressObserver = std::function<void(const Progress&)>;

/// The whole of fairway on one file in memory: decode → topology → flow → curvature → encode.
/// A mesh of the file that has no usable triangle stays as it is, with a note, as long as another
/// one has some, and so does what the parameters do not select. `side_files` are those that a glTF
/// may name beside itself. Errors: those of decode(), select_surfaces(), TriangleMesh::build(),
/// denoise() and encode().
Result<PipelineOutput> run_pipeline(std::span<const std::byte> input, Format format,
                                    const Parameters& parameters, const ProgressObserver& observer,
                                    const std::stop_token& stop, const SideFiles& side_files = {});

}  // namespace fairway
