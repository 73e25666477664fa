#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// The uploads that are being written, each by one request. A new request takes over: the one
/// before may be all that is left of a connection that broke.
class UploadsInFlight {
 public:
  /// Holds an upload while it lives.
  class Guard {
   public:
    Guard(UploadsInFlight& uploads, std::string id) : uploads_(&uploads), id_(std::move(id)) {}
    Guard(Guard&& other) noexcept
        : uploads_(std::exchange(other.uploads_, nullptr)), id_(std::move(other.id_)) {}
    Guard& operator=(Guard&&) = delete;
    ~Guard() {
      if (uploads_ != nullptr) uploads_->leave(id_);
    }

   private:
    UploadsInFlight* uploads_;
    std::string id_;
  };

  /// Interrupts the body that holds the upload, and waits for its end; `body` has to outlive the
  /// guard. Nothing where that end does not come within ten seconds.
  std::optional<Guard> take_over(const std::string& id, BodySource& body);

  /// Holds an upload that nothing comes for. Nothing where something does, or may.
  std::optional<Guard> enter(const std::string& id);

 private:
  void leave(const std::string& id);

  std::mutex mutex_;
  std::condition_variable left_;
  std::map<std::string, BodySource*> bodies_;  ///< null: held without one
};

}  // namespace fairway
