#include "server/fairwayd/api/job_version.h"

#include <fmt/format.h>

namespace fairway {

EntityTag version_of(const Job& job) {
  return {fmt::format("r{}", job.revision), true};
}

void add_version(HttpResponse& response, const Job& job) {
  response.headers.emplace_back("ETag", to_string(version_of(job)));
  response.headers.emplace_back("Cache-Control", "private, no-cache");
}

}  // namespace fairway
