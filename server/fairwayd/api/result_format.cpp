// Which format of a result a client wants.
#include "server/fairwayd/api/result_format.h"

#include <array>
#include <optional>

#include <fmt/format.h>

#include "server/fairwayd/api/routes.h"
#include "server/fairwayd/http/http_accept.h"
#include "server/fairwayd/http/http_prefer.h"

namespace fairway {
namespace {

/// The one that the client wants most.
std::optional<Format> chosen_format(const HttpRequest& request) {
  constexpr std::array kChoices = {Format::glb, Format::gltf, Format::ply, Format::obj,
                                   Format::stl};
  std::optional<Format> chosen;
  int most = 0;
  for (const Format format : kChoices) {
    const int weight = accept_weight(request, media_type_of(format));
    if (weight <= most) continue;
    most = weight;
    chosen = format;
  }
  return chosen;
}

}  // namespace

Error not_acceptable(Format format) {
  return {ErrorCode::not_acceptable,
          fmt::format("The result is {}, which the Accept header excludes: allow it, or choose "
                      "another format with the parameter output.",
                      media_type_of(format))};
}

Result<void> heed_accept(const HttpRequest& request, Upload& upload) {
  const auto route = route_of(request.path);
  if (!route || route->place != Place::denoise) return {};
  const Format made = upload.parameters.output.value_or(upload.format);
  if (accept_weight(request, media_type_of(made)) > 0) return {};
  if (!upload.parameters.output) {
    upload.parameters.output = chosen_format(request);
    if (upload.parameters.output) return {};
  }
  const Preferences wanted = preferences_of(request);
  if (wanted.respond_async || wanted.wait) return {};
  return not_acceptable(made);
}

}  // namespace fairway
