// Forms, piece by piece. The library's own parser matches the lines of a part's head with a
// recursive regular expression, and takes any number of them: one part costs minutes, or the stack.
#include "server/fairwayd/http/multipart_reader.h"

#include <algorithm>
#include <utility>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

constexpr std::size_t kPiece = 64 * 1024;
constexpr std::size_t kMaxBoundary = 70;
constexpr std::string_view kLineEnd = "\r\n";

Error malformed() {
  return {ErrorCode::bad_request,
          "The body is not well-formed multipart/form-data: check boundary and parts."};
}

bool is_boundary_character(char c) {
  constexpr std::string_view kOthers = "'()+_,-./:=? ";
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         kOthers.find(c) != std::string_view::npos;
}

/// A quoted string's content from behind its opening quote on, with what stands behind it. As
/// browsers write it: a backslash escapes quotes and backslashes only.
struct Quoted {
  std::string text;
  std::string_view rest;
};

std::optional<Quoted> take_quoted(std::string_view from) {
  Quoted quoted;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i] == '"') {
      quoted.rest = from.substr(i + 1);
      return quoted;
    }
    const bool escapes =
        from[i] == '\\' && i + 1 < from.size() && (from[i + 1] == '"' || from[i + 1] == '\\');
    if (escapes) ++i;
    quoted.text += from[i];
  }
  return std::nullopt;
}

/// The name and the file name of a disposition's parameters, "; name=value" each. False: broken.
bool take_parameters(std::string_view text, PartHead& head) {
  while (!(text = trim_blanks(text)).empty()) {
    if (text.front() != ';') return false;
    text = trim_blanks(text.substr(1));
    if (text.empty()) return true;
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) return false;
    const std::string name = lower_case(trim_blanks(text.substr(0, equals)));
    if (!is_token(name)) return false;
    text = trim_blanks(text.substr(equals + 1));
    std::string value;
    if (text.starts_with('"')) {
      auto quoted = take_quoted(text.substr(1));
      if (!quoted) return false;
      value = std::move(quoted->text);
      text = quoted->rest;
    } else {
      value = trim_blanks(text.substr(0, text.find(';')));
      text = text.substr(std::min(text.find(';'), text.size()));
    }
    if (name == "name") {
      head.name = std::move(value);
    } else if (name == "filename") {
      head.file_name = std::move(value);
    }
  }
  return true;
}

/// One line of a part's head. False: broken.
bool take_field(std::string_view line, PartHead& head, bool& has_disposition) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) return false;
  const std::string_view name = line.substr(0, colon);
  const std::string_view value = trim_blanks(line.substr(colon + 1));
  if (same_word(name, "Content-Type")) {
    head.content_type = value;
  } else if (same_word(name, "Content-Disposition")) {
    if (std::exchange(has_disposition, true)) return false;
    const std::size_t end = std::min(value.find(';'), value.size());
    return same_word(trim_blanks(value.substr(0, end)), "form-data") &&
           take_parameters(value.substr(end), head);
  }
  return true;
}

}  // namespace

std::optional<std::string> form_boundary(std::string_view content_type) {
  const auto parts = split_field(content_type, ';');
  if (parts.empty() || !same_word(parts.front(), "multipart/form-data")) return std::nullopt;
  std::optional<std::string> boundary;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (!same_word(parts[i].substr(0, parts[i].find('=')), "boundary")) continue;
    if (boundary || parts[i].find('=') == std::string_view::npos) return std::nullopt;
    std::string_view value = parts[i].substr(parts[i].find('=') + 1);
    if (value.size() >= 2 && value.starts_with('"') && value.ends_with('"')) {
      value = value.substr(1, value.size() - 2);
    }
    boundary = value;
  }
  const bool good = boundary && !boundary->empty() && boundary->size() <= kMaxBoundary &&
                    boundary->back() != ' ' &&
                    std::all_of(boundary->begin(), boundary->end(), is_boundary_character);
  return good ? boundary : std::nullopt;
}

MultipartReader::MultipartReader(const std::string& boundary, ReadBody read_body)
    : read_body_(std::move(read_body)), edge_("\r\n--" + boundary) {}

/// More bytes of the body behind those that are unread. False: there are none.
Result<bool> MultipartReader::fill() {
  buffer_.erase(0, std::exchange(at_, 0));
  const std::size_t had = buffer_.size();
  buffer_.resize(had + kPiece);
  const auto got = read_body_(std::span(buffer_).subspan(had));
  buffer_.resize(had + (got ? *got : 0));
  if (!got) return got.error();
  return *got > 0;
}

/// Until so many bytes are unread.
Result<void> MultipartReader::require(std::size_t bytes) {
  while (unread().size() < bytes) {
    const auto more = fill();
    if (!more) return more.error();
    if (!*more) return malformed();
  }
  return {};
}

/// The first boundary, whose line may begin the body.
Result<void> MultipartReader::skip_opening() {
  if (auto here = require(edge_.size()); !here) return here;
  const std::string_view edge = unread().starts_with(kLineEnd)
                                    ? std::string_view(edge_)
                                    : std::string_view(edge_).substr(kLineEnd.size());
  if (!unread().starts_with(edge)) return malformed();
  at_ += edge.size();
  return {};
}

/// A line without its end; valid until more is read.
Result<std::string_view> MultipartReader::take_line(std::size_t limit) {
  while (true) {
    const std::size_t end = unread().substr(0, limit + kLineEnd.size()).find(kLineEnd);
    if (end != std::string_view::npos) {
      const std::string_view line = unread().substr(0, end);
      at_ += end + kLineEnd.size();
      return line;
    }
    if (unread().size() >= limit + kLineEnd.size()) return malformed();
    const auto more = fill();
    if (!more) return more.error();
    if (!*more) return malformed();
  }
}

Result<PartHead> MultipartReader::read_head() {
  PartHead head;
  bool has_disposition = false;
  std::size_t left = kMaxPartHeadBytes;
  for (std::size_t i = 0; i <= kMaxPartHeaders; ++i) {
    const auto line = take_line(left);
    if (!line) return line.error();
    if (line->empty()) return has_disposition ? Result<PartHead>(std::move(head)) : malformed();
    left -= line->size();
    if (!take_field(*line, head, has_disposition)) return malformed();
  }
  return malformed();
}

/// The content of a part, up to behind the boundary that ends it.
Result<void> MultipartReader::pass_content(const BodySource::OnBytes& on_bytes) {
  while (true) {
    const std::size_t end = unread().find(edge_);
    const bool ends = end != std::string_view::npos;
    // Without one, the last bytes may be the begin of one.
    const std::size_t sure =
        ends ? end : unread().size() - std::min(unread().size(), edge_.size() - 1);
    if (sure > 0) {
      auto taken = on_bytes(std::as_bytes(std::span(unread().substr(0, sure))));
      if (!taken) return taken;
    }
    at_ += sure + (ends ? edge_.size() : 0);
    if (ends) return {};
    const auto more = fill();
    if (!more) return more.error();
    if (!*more) return malformed();
  }
}

/// What follows a boundary: the end of its line, or that of the form.
Result<bool> MultipartReader::another_part() {
  if (auto here = require(kLineEnd.size()); !here) return here.error();
  const std::string_view mark = unread().substr(0, kLineEnd.size());
  if (mark != kLineEnd && mark != "--") return malformed();
  const bool another = mark == kLineEnd;
  at_ += kLineEnd.size();
  return another;
}

Result<void> MultipartReader::skip_epilogue() {
  while (unread().size() <= kMaxEpilogueBytes) {
    const auto more = fill();
    if (!more) return more.error();
    if (!*more) return {};
  }
  return malformed();
}

Result<void> MultipartReader::read(const BodySource::OnPart& on_part,
                                   const BodySource::OnBytes& on_bytes) {
  if (auto opened = skip_opening(); !opened) return opened;
  while (true) {
    const auto another = another_part();
    if (!another) return another.error();
    if (!*another) return skip_epilogue();
    const auto head = read_head();
    if (!head) return head.error();
    if (auto taken = on_part(*head); !taken) return taken;
    if (auto passed = pass_content(on_bytes); !passed) return passed;
  }
}

}  // namespace fairway
