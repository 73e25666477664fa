#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// Limits of the head of one part of a form.
inline constexpr std::size_t kMaxPartHeadBytes = 8192;
inline constexpr std::size_t kMaxPartHeaders = 16;
/// What may follow the last boundary; senders add at most a line end.
inline constexpr std::size_t kMaxEpilogueBytes = 1024;

/// The boundary that a multipart/form-data content type names (RFC 2046, 5.1.1: at most 70
/// characters of a closed set). Nothing where the type is another one or the boundary is not good.
std::optional<std::string> form_boundary(std::string_view content_type);

/// Parses a multipart/form-data body (RFC 7578) while it arrives. Holds at most one head of a part
/// and one piece of a body; takes time linear in the bytes, whatever they are.
class MultipartReader {
 public:
  /// Fills the space from its begin; 0 at the end of the body.
  using ReadBody = std::function<Result<std::size_t>(std::span<char>)>;

  MultipartReader(const std::string& boundary, ReadBody read_body);

  /// To the end of the body: `on_part` at each head, then `on_bytes` with its content in pieces.
  /// Errors: bad_request (not well-formed, or a head beyond its limits), what reading the body
  /// answers, and what the callbacks do.
  Result<void> read(const BodySource::OnPart& on_part, const BodySource::OnBytes& on_bytes);

 private:
  std::string_view unread() const { return std::string_view(buffer_).substr(at_); }
  Result<bool> fill();
  Result<void> require(std::size_t bytes);
  Result<void> skip_opening();
  Result<PartHead> read_head();
  Result<std::string_view> take_line(std::size_t limit);
  Result<void> pass_content(const BodySource::OnBytes& on_bytes);
  Result<bool> another_part();
  Result<void> skip_epilogue();

  const ReadBody read_body_;
  const std::string edge_;  ///< CRLF, two dashes, the boundary
  std::string buffer_;      ///< received, not yet passed on
  std::size_t at_ = 0;      ///< the consumed part of buffer_
};

}  // namespace fairway
