#include "server/fairwayd/http/connection_roster.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <tuple>
#include <utility>

#include <netinet/in.h>

namespace fairway {
namespace {

using Clock = ClientPace::Clock;
using std::chrono::milliseconds;

/// How readily a connection gives way; 0: not at all. `is_excess`: of an origin that holds most
/// places, for one that holds few; then it is enough that the client is waited for.
int readiness(const ClientPace::Waiting& waiting, bool is_excess) {
  switch (waiting.phase) {
    case ClientPhase::busy:
      return 0;
    case ClientPhase::idle:
      return waiting.lag >= milliseconds(100) ? 3 : 0;
    case ClientPhase::head:
      return waiting.lag >= milliseconds(500) ? 2 : 0;
    case ClientPhase::body:
    case ClientPhase::answer:
      return is_excess || waiting.lag >= milliseconds(1000) ? 1 : 0;
  }
  return 0;
}

}  // namespace

std::string origin_of(const sockaddr_storage& peer) {
  constexpr std::size_t kNetwork = 8;
  if (peer.ss_family == AF_INET) {
    const auto& four = reinterpret_cast<const sockaddr_in&>(peer);
    return {reinterpret_cast<const char*>(&four.sin_addr), sizeof four.sin_addr};
  }
  if (peer.ss_family == AF_INET6) {
    const auto& six = reinterpret_cast<const sockaddr_in6&>(peer);
    const auto* bytes = reinterpret_cast<const char*>(&six.sin6_addr);
    // An IPv4 address in a socket for both is one address, not a network.
    return IN6_IS_ADDR_V4MAPPED(&six.sin6_addr) != 0 ? std::string(bytes + 12, 4)
                                                     : std::string(bytes, kNetwork);
  }
  return {};
}

ConnectionRoster::Entry::Entry(ConnectionRoster& roster, Connection& connection, std::string origin)
    : roster_(roster), connection_(connection) {
  const std::lock_guard lock(roster_.mutex_);
  roster_.rows_.push_back({&connection, std::move(origin), false});
}

ConnectionRoster::Entry::~Entry() {
  const std::lock_guard lock(roster_.mutex_);
  std::erase_if(roster_.rows_, [this](const Row& row) { return row.connection == &connection_; });
}

bool ConnectionRoster::make_room(const std::string& origin) {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  std::map<std::string_view, std::size_t> counts;
  for (const Row& row : rows_) counts[row.origin] += row.evicted ? 0 : 1;
  const std::size_t own = counts[origin];
  Row* chosen = nullptr;
  std::tuple<std::size_t, int, Clock::duration> best{};
  for (Row& row : rows_) {
    const std::size_t count = counts[row.origin];
    if (row.evicted || (row.origin != origin && count <= own)) continue;
    const auto waiting = row.connection->waiting(now);
    const bool is_excess = row.origin != origin && 2 * count > rows_.size() && 2 * own < count;
    const std::tuple rank{count, readiness(waiting, is_excess), waiting.lag};
    if (std::get<1>(rank) == 0 || (chosen != nullptr && rank <= best)) continue;
    chosen = &row;
    best = rank;
  }
  if (chosen == nullptr) return false;
  chosen->evicted = true;
  chosen->connection->evict();
  return true;
}

}  // namespace fairway
