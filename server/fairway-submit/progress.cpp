#include "server/fairway-submit/progress.h"

#include <cstdio>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "server/fairway-submit/json_fields.h"

namespace fairway {
namespace {

constexpr std::size_t kWidth = 30;

/// One line, whatever a server or a file name puts into it.
std::string harmless(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return out;
}

/// A bar that wraps could not be drawn over.
std::size_t columns() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

std::string sentence_of(const Json& problem) {
  const std::string pointer = text_in(problem, "pointer");
  const std::string title = text_in(problem, "title");
  const std::string detail = text_in(problem, "detail");
  return fmt::format("{}{}{}{}", title, title.empty() || detail.empty() ? "" : ": ", detail,
                     pointer.empty() ? "" : fmt::format(" (at {})", pointer));
}

}  // namespace

ProgressDisplay::ProgressDisplay(Style style, std::size_t files) : style_(style), files_(files) {}

void ProgressDisplay::begun() {
  const std::lock_guard lock(mutex_);
  ++running_;
}

void ProgressDisplay::ended(std::string_view label, const FileOutcome& outcome) {
  const std::lock_guard lock(mutex_);
  --running_;
  bytes_ += outcome.sent_bytes;
  if (outcome.state == FileState::unfinished && outcome.problem.is_null()) return;
  ++ended_;
  const bool bad = outcome.state == FileState::failed || outcome.state == FileState::unfinished;
  if (bad) {
    ++failed_;
    return line(fmt::format("[{}/{}] {}: {}: {}", ended_, files_, harmless(label),
                            name_of(outcome.state), harmless(sentence_of(outcome.problem))));
  }
  if (style_ != Style::lines) return;
  if (outcome.state == FileState::kept) {
    return line(fmt::format("[{}/{}] {}: is there already", ended_, files_, harmless(label)));
  }
  line(fmt::format("[{}/{}] {}: {} bytes, {:.2f} s", ended_, files_, harmless(label),
                   outcome.result_bytes, static_cast<double>(outcome.took.count()) / 1000.0));
}

void ProgressDisplay::server_missing(const std::string& why) {
  const std::lock_guard lock(mutex_);
  const bool known = !missing_.empty();
  missing_ = why;
  if (!known && style_ == Style::lines) {
    line(fmt::format("The server is missing ({}); trying on.", harmless(why)));
  }
}

void ProgressDisplay::server_answers() {
  const std::lock_guard lock(mutex_);
  if (missing_.empty()) return;
  missing_.clear();
  if (style_ == Style::lines) line("The server answers again.");
}

void ProgressDisplay::say(std::string_view text) {
  const std::lock_guard lock(mutex_);
  line(text);
}

void ProgressDisplay::line(std::string_view text) {
  fmt::print(stderr, "{}{}\n", drawn_ ? "\r\033[K" : "", text);
  drawn_ = false;
}

void ProgressDisplay::draw() {
  if (style_ != Style::terminal) return;
  const std::lock_guard lock(mutex_);
  const std::size_t filled = files_ == 0 ? kWidth : kWidth * ended_ / files_;
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  const auto time =
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::steady_clock::now() - began_);
  std::string text = fmt::format("[{}] {}/{}, {} in work", bar, ended_, files_, running_);
  if (failed_ > 0) text += fmt::format(", {} failed", failed_);
  text += fmt::format(", {:.1f} MB sent, {} s", static_cast<double>(bytes_) / 1e6, time.count());
  if (!missing_.empty()) text += fmt::format(" - no server: {}", harmless(missing_));
  fmt::print(stderr, "\r{}\033[K", text.substr(0, columns() - 1));
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressDisplay::clear() {
  const std::lock_guard lock(mutex_);
  if (drawn_) fmt::print(stderr, "\r\033[K");
  drawn_ = false;
}

}  // namespace fairway
