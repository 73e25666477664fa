#include "server/fairway-submit/journal.h"

#include <array>
#include <cerrno>
#include <span>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "server/fairway-submit/json_fields.h"
#include "server/os/file.h"
#include "server/os/random_id.h"

namespace fairway {
namespace {

constexpr int kVersion = 1;

Error no_journal() {
  return {ErrorCode::usage,
          "The journal in --out was not written by this program: choose another --out."};
}

Result<std::string> read_all(int fd) {
  std::string text;
  std::array<char, 65536> chunk;
  for (;;) {
    const ssize_t got = ::read(fd, chunk.data(), chunk.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return file_error("read the journal", errno);
    if (got == 0) return text;
    text.append(chunk.data(), static_cast<std::size_t>(got));
  }
}

Json line_of(const std::string& name, const JournalEntry& entry) {
  Json line{{"file", name}, {"payload", entry.payload}, {"attempt", entry.attempt}};
  if (!entry.server.empty()) line["server"] = entry.server;
  if (!entry.job.empty()) line["job"] = entry.job;
  if (entry.result) {
    line["result"] = {{"sha256", entry.result->sha256}, {"bytes", entry.result->bytes}};
  }
  if (entry.problem) line["problem"] = *entry.problem;
  return line;
}

}  // namespace

Journal::Journal(Journal&& other) noexcept
    : fd_(std::move(other.fd_)),
      batch_(std::move(other.batch_)),
      entries_(std::move(other.entries_)),
      wrote_(std::move(other.wrote_)) {}

Result<Journal> Journal::open(const std::filesystem::path& path) {
  auto fd = open_file(path, O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW);
  if (!fd) return fd.error();
  const auto text = read_all(fd->get());
  if (!text) return text.error();
  Journal journal(*std::move(fd));
  // What a crash left of a line is cut off, so that the next one begins a line.
  const std::size_t whole = text->rfind('\n') == std::string::npos ? 0 : text->rfind('\n') + 1;
  if (whole == 0 && !text->empty() && !text->starts_with("{\"batch\"")) return no_journal();
  if (whole < text->size() && ::ftruncate(journal.fd_.get(), static_cast<off_t>(whole)) != 0) {
    return file_error("mend the journal", errno);
  }
  if (auto read = journal.read(text->substr(0, whole)); !read) return read.error();
  if (!journal.batch_.empty()) return journal;
  journal.batch_ = random_id();
  const Json first{{"batch", journal.batch_}, {"version", kVersion}};
  if (auto begun = journal.append(first); !begun) return begun.error();
  const auto folder = path.parent_path();
  if (auto done = sync_directory(folder.empty() ? "." : folder); !done) return done.error();
  return journal;
}

Result<void> Journal::read(const std::string& text) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    const auto line = parse_json(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
    if (!line || !line->is_object()) return no_journal();
    if (auto read = read_line(*line); !read) return read;
  }
  return {};
}

Result<void> Journal::read_line(const Json& line) {
  if (batch_.empty()) {
    batch_ = text_in(line, "batch");
    if (batch_.empty() || number_in(line, "version") != kVersion) return no_journal();
    return {};
  }
  const std::string name = text_in(line, "file");
  JournalEntry entry{text_in(line, "payload"),
                     static_cast<int>(number_in(line, "attempt")),
                     text_in(line, "server"),
                     text_in(line, "job"),
                     {},
                     {}};
  if (name.empty() || entry.payload.empty()) return no_journal();
  if (const auto result = line.find("result"); result != line.end()) {
    entry.result = KeptResult{text_in(*result, "sha256"), number_in(*result, "bytes")};
    wrote_[name] = true;
  }
  if (const auto problem = line.find("problem"); problem != line.end()) entry.problem = *problem;
  entries_[name] = std::move(entry);
  return {};
}

Result<void> Journal::append(const Json& line) {
  const std::string text = dump_json(line) + '\n';
  const off_t end = ::lseek(fd_.get(), 0, SEEK_END);
  if (auto written = write_all(fd_.get(), std::as_bytes(std::span(text))); !written) {
    // Half a line would spoil the next one; where even this fails, the journal is refused later.
    [[maybe_unused]] const int undone = ::ftruncate(fd_.get(), end);
    return written;
  }
  if (::fdatasync(fd_.get()) != 0) return file_error("make the journal durable", errno);
  return {};
}

bool Journal::wrote(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  return wrote_.contains(name);
}

JournalEntry Journal::entry(const std::string& name, const std::string& payload) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(name);
  if (found != entries_.end() && found->second.payload == payload) return found->second;
  return {.payload = payload};
}

Result<void> Journal::put(const std::string& name, const JournalEntry& entry) {
  const std::lock_guard lock(mutex_);
  if (auto appended = append(line_of(name, entry)); !appended) return appended;
  if (entry.result) wrote_[name] = true;
  entries_[name] = entry;
  return {};
}

}  // namespace fairway
