#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace fairway {

/// The idempotency keys of submits whose upload is still on its way to this server.
class KeysInFlight {
 public:
  /// Holds a key while it lives.
  class Guard {
   public:
    Guard(KeysInFlight& keys, std::string key) : keys_(&keys), key_(std::move(key)) {}
    Guard(Guard&& other) noexcept
        : keys_(std::exchange(other.keys_, nullptr)), key_(std::move(other.key_)) {}
    Guard& operator=(Guard&&) = delete;
    ~Guard() {
      if (keys_ != nullptr) keys_->leave(key_);
    }

   private:
    KeysInFlight* keys_;
    std::string key_;
  };

  /// Nothing where the key is in flight already.
  std::optional<Guard> enter(const std::string& key) {
    const std::lock_guard lock(mutex_);
    if (!keys_.insert(key).second) return std::nullopt;
    return Guard(*this, key);
  }

 private:
  void leave(const std::string& key) {
    const std::lock_guard lock(mutex_);
    keys_.erase(key);
  }

  std::mutex mutex_;
  std::set<std::string> keys_;
};

}  // namespace fairway
