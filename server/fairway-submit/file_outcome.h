#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "proto/messages/json.h"

namespace fairway {

/// How a file of a batch ended.
enum class FileState {
  succeeded,   ///< its result has come
  kept,        ///< its result was there, from an earlier run
  failed,      ///< there will be none; `problem` says why
  unfinished,  ///< none yet: the same command goes on with it
};

/// "succeeded" …
constexpr const char* name_of(FileState state) {
  switch (state) {
    case FileState::succeeded:
      return "succeeded";
    case FileState::kept:
      return "kept";
    case FileState::failed:
      return "failed";
    case FileState::unfinished:
      break;
  }
  return "unfinished";
}

struct FileOutcome {
  FileState state = FileState::unfinished;
  std::string job;                 ///< empty: none was accepted
  std::uint64_t sent_bytes = 0;    ///< of the upload; 0 where none was needed
  std::uint64_t result_bytes = 0;  ///< of the file that is there now
  std::string sha256;              ///< of it
  std::chrono::milliseconds took{0};
  Json problem;  ///< RFC 9457; null: none
};

}  // namespace fairway
