// Which method runs, and what all of them check first.

#include "core/denoise.h"

#include <string>

#include "core/flow_run.h"
#include "core/variational_run.h"

namespace fairway {

Result<Denoised> denoise(const TriangleMesh& surface, const FlowOptions& options,
                         const FlowObserver& observer, std::stop_token stop,
                         const Execution& execution) {
  const std::size_t sources = surface.vertex_of_source().size();
  for (const Index v : options.fixed_vertices) {
    if (v < sources) continue;
    return Error{ErrorCode::invalid_parameters, "Fixed vertex " + std::to_string(v) +
                                                    " is not among the " + std::to_string(sources) +
                                                    " of the source; count from 0."};
  }
  Result<Denoised> done = options.method == Method::variational
                              ? run_variational(surface, options, observer, stop, execution)
                              : run_flow(surface, options, observer, stop, execution);
  if (done) done->report.method = options.method;
  return done;
}

NoiseFinding find_noise(const TriangleMesh& surface, const Execution& execution) {
  return look_for_noise(surface, execution);
}

}  // namespace fairway
