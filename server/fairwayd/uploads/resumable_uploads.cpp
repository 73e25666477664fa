#include "server/fairwayd/uploads/resumable_uploads.h"

#include <algorithm>
#include <cerrno>
#include <set>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "server/fairwayd/uploads/file_spool.h"
#include "server/fairwayd/uploads/upload.h"
#include "server/os/file.h"
#include "server/os/random_id.h"

namespace fairway {
namespace {

namespace fs = std::filesystem;

/// Uploads of one round of the sweeper.
constexpr std::size_t kBatch = 100;

/// Bytes from a file's start, fewer where it ends before.
Result<std::size_t> read_at(int file, std::span<std::byte> space, std::uint64_t offset) {
  while (true) {
    const ssize_t got = ::pread(file, space.data(), space.size(), static_cast<off_t>(offset));
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR) return file_error("read an upload", errno);
  }
}

/// The file of a row that was there a moment ago.
Result<UniqueFd> open_bytes(const fs::path& path, int flags) {
  UniqueFd file(::open(path.c_str(), flags | O_CLOEXEC));
  if (file) return file;
  if (errno == ENOENT) return Error{ErrorCode::gone, "The upload is gone: create a new one."};
  return file_error("open an upload", errno);
}

Result<void> sync_file(int file) {
  if (::fdatasync(file) != 0) return file_error("make an upload durable", errno);
  return {};
}

Result<void> remove_file(const fs::path& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return file_error("remove an upload", errno);
  return {};
}

/// Lets each piece of a body through as long as it fits.
Result<void> read_within(BodySource& body, std::uint64_t left, const BodySource::OnBytes& take) {
  return body.read([&](std::span<const std::byte> bytes) -> Result<void> {
    if (bytes.size() > left) {
      return Error{ErrorCode::too_large, "More bytes came than Upload-Length has said."};
    }
    left -= bytes.size();
    return take(bytes);
  });
}

Result<void> copy_all(int from, int to) {
  std::vector<std::byte> space(std::size_t{1} << 18);
  for (std::uint64_t at = 0;;) {
    const auto got = read_at(from, space, at);
    if (!got) return got.error();
    if (*got == 0) return {};
    if (auto done = write_all(to, std::span(space).first(*got)); !done) return done;
    at += *got;
  }
}

}  // namespace

Result<std::unique_ptr<ResumableUploads>> ResumableUploads::open(UploadStore& store,
                                                                 BlobStore& blobs,
                                                                 const fs::path& directory,
                                                                 const Options& options) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) return file_error("create " + directory.string(), error.value());
  if (auto synced = sync_directory(directory.parent_path()); !synced) return synced.error();
  return std::unique_ptr<ResumableUploads>(new ResumableUploads(store, blobs, directory, options));
}

Result<std::size_t> ResumableUploads::recover() {
  const auto rows = store_.open_uploads();
  if (!rows) return rows.error();
  std::size_t removed = 0;
  std::set<std::string> ids;
  for (const UploadName& name : *rows) {
    ids.insert(name.id);
    if (::access(path_of(name).c_str(), F_OK) == 0) continue;
    if (auto done = store_.remove(name); !done) return done.error();
    ++removed;
  }
  std::error_code error;
  fs::directory_iterator entries(directory_, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    if (ids.count(entries->path().filename().string()) > 0) continue;
    if (auto done = remove_file(entries->path()); !done) return done.error();
    ++removed;
  }
  if (error) return file_error("list " + directory_.string(), error.value());
  return removed;
}

/// The file is there before the row, so that a row is never without one.
Result<ResumableUpload> ResumableUploads::create(const std::string& tenant, std::uint64_t length,
                                                 std::string_view metadata) {
  if (length == 0) return Error{ErrorCode::bad_request, "A mesh has more than 0 bytes."};
  if (length > options_.max_bytes) return upload_too_large(options_.max_bytes);
  if (auto parsed = parse_upload_metadata(metadata); !parsed) return parsed.error();
  if (auto room = check_disk(blobs_, options_.min_free, length); !room) return room.error();
  const UploadName name{tenant, random_id()};
  auto file = open_file(path_of(name), O_WRONLY | O_CREAT | O_EXCL);
  if (!file) return file.error();
  auto synced = sync_directory(directory_);
  auto created =
      synced ? store_.create({name, length, std::string(metadata), options_.keep}, options_.limits)
             : Result<ResumableUpload>(synced.error());
  if (created) return created;
  if (auto removed = remove_file(path_of(name)); !removed) return removed.error();
  return created;
}

Result<ResumableUpload> ResumableUploads::find_open(const UploadName& name) {
  auto upload = store_.find(name);
  if (!upload || !upload->used) return upload;
  return Error{ErrorCode::gone, "The upload has become a job: create a new one for another file."};
}

/// Only what the disk has is told: the client forgets those bytes.
Result<UploadState> ResumableUploads::state(const UploadName& name) {
  auto upload = find_open(name);
  if (!upload) return upload.error();
  auto file = open_bytes(path_of(name), O_RDONLY);
  if (!file) return file.error();
  const auto bytes = size_of(file->get());
  if (!bytes) return bytes.error();
  if (auto synced = sync_file(file->get()); !synced) return synced.error();
  return UploadState{*std::move(upload), *bytes};
}

Result<UploadState> ResumableUploads::append(const UploadName& name, const UploadChunk& chunk,
                                             BodySource& body) {
  // Nobody interrupts an upload that is not his own.
  if (auto mine = find_open(name); !mine) return mine.error();
  const auto alone = in_flight_.take_over(name.id, body);
  if (!alone) {
    return Error{ErrorCode::conflict,
                 "Bytes of another request are on their way: ask for the offset and go on there."};
  }
  const auto before = find_open(name);
  if (!before) return before.error();
  auto file = open_bytes(path_of(name), O_WRONLY | O_APPEND);
  if (!file) return file.error();
  const auto had = size_of(file->get());
  if (!had) return had.error();
  if (*had != chunk.offset) {
    return Error{ErrorCode::conflict,
                 fmt::format("The upload is at {}, the bytes are for {}: send them from there.",
                             *had, chunk.offset)};
  }
  const std::uint64_t left = before->length - std::min(before->length, *had);
  if (chunk.bytes.value_or(0) > left) {
    return Error{ErrorCode::too_large,
                 fmt::format("{} bytes of the upload are left, more are to come.", left)};
  }
  if (auto room = check_disk(blobs_, options_.min_free, chunk.bytes.value_or(0)); !room) {
    return room.error();
  }
  const auto received = receive(file->get(), left, chunk, body);
  // What came stays, also where the rest did not, and is a sign of life.
  if (auto synced = sync_file(file->get()); !synced) return synced.error();
  const auto has = size_of(file->get());
  if (!has) return has.error();
  auto after = store_.extend(name);
  if (!received) return received.error();
  if (!after) return after.error();
  return UploadState{*std::move(after), *has};
}

/// Bytes with a checksum wait elsewhere until it is known to be right: a crash must not leave any
/// of them that are not.
Result<void> ResumableUploads::receive(int file, std::uint64_t left, const UploadChunk& chunk,
                                       BodySource& body) {
  if (!chunk.checksum) {
    return read_within(body, left,
                       [file](std::span<const std::byte> bytes) { return write_all(file, bytes); });
  }
  auto draft = blobs_.create();
  if (!draft) return draft.error();
  Checksum sum(chunk.checksum->algorithm);
  auto received = read_within(body, left, [&](std::span<const std::byte> bytes) {
    sum.update(bytes);
    return (*draft)->append(bytes);
  });
  if (!received) return received;
  if (sum.finish() != chunk.checksum->digest) {
    return Error{ErrorCode::checksum_mismatch,
                 "The bytes are not those of Upload-Checksum: send them again."};
  }
  return copy_all((*draft)->descriptor(), file);
}

Result<void> ResumableUploads::remove(const UploadName& name) {
  if (auto upload = find_open(name); !upload) return upload.error();
  if (auto removed = store_.remove(name); !removed) return removed;
  return remove_file(path_of(name));
}

Result<ResumableUpload> ResumableUploads::whole(const UploadName& name) {
  auto upload = store_.find(name);
  if (!upload || upload->used) return upload;
  const auto state = this->state(name);
  if (!state) return state.error();
  if (state->offset == upload->length) return upload;
  return Error{ErrorCode::not_ready,
               fmt::format("The upload has {} bytes of {}: send the rest first.", state->offset,
                           upload->length)};
}

Result<Format> ResumableUploads::recognise(const ResumableUpload& upload) {
  const auto metadata = parse_upload_metadata(upload.metadata);
  if (!metadata) return metadata.error();
  auto file = open_bytes(path_of(upload.name), O_RDONLY);
  if (!file) return file.error();
  std::vector<std::byte> head(kMagicBytes);
  const auto got = read_at(file->get(), head, 0);
  if (!got) return got.error();
  head.resize(*got);
  return recognise_format(head, metadata->file_type, metadata->file_name);
}

Result<BlobInfo> ResumableUploads::give(const ResumableUpload& upload, std::string_view key) {
  return blobs_.adopt(path_of(upload.name), key);
}

Result<void> ResumableUploads::drop_bytes(const UploadName& name) {
  return remove_file(path_of(name));
}

Result<std::size_t> ResumableUploads::sweep(UnixMillis now) {
  const auto due = store_.due(now, kBatch);
  if (!due) return due.error();
  std::size_t swept = 0;
  for (const UploadName& name : *due) {
    const auto alone = in_flight_.enter(name.id);
    if (!alone) continue;
    const auto expired = store_.expire(name, now);
    if (!expired) return expired.error();
    if (!*expired) continue;
    if (auto removed = remove_file(path_of(name)); !removed) return removed.error();
    ++swept;
  }
  return swept;
}

}  // namespace fairway
