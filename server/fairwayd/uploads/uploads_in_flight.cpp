#include "server/fairwayd/uploads/uploads_in_flight.h"

#include <chrono>

namespace fairway {
namespace {

/// For what an interrupted request still has to write and to make durable.
constexpr std::chrono::seconds kPatience{10};

}  // namespace

std::optional<UploadsInFlight::Guard> UploadsInFlight::take_over(const std::string& id,
                                                                 BodySource& body) {
  std::unique_lock lock(mutex_);
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!bodies_.try_emplace(id, &body).second) {
    // Under the lock, since a body may go as soon as its upload has been left. It does not wait.
    if (BodySource* earlier = bodies_.at(id); earlier != nullptr) earlier->interrupt();
    if (left_.wait_until(lock, until) == std::cv_status::timeout) return std::nullopt;
  }
  return Guard(*this, id);
}

std::optional<UploadsInFlight::Guard> UploadsInFlight::enter(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (!bodies_.try_emplace(id, nullptr).second) return std::nullopt;
  return Guard(*this, id);
}

void UploadsInFlight::leave(const std::string& id) {
  {
    const std::lock_guard lock(mutex_);
    bodies_.erase(id);
  }
  left_.notify_all();
}

}  // namespace fairway
