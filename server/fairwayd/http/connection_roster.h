#pragma once

#include <mutex>
#include <string>
#include <vector>

#include <sys/socket.h>

#include "server/fairwayd/http/connection.h"

namespace fairway {

/// Whom connections are counted for: an IPv4 address, or the 64 bits of an IPv6 network that one
/// household gets. Text of no meaning but equality.
std::string origin_of(const sockaddr_storage& peer);

/// The connections that are served now, and which of them gives way where there is no room for
/// another. Any thread.
class ConnectionRoster {
 public:
  /// Enters a connection, and strikes it out in the end.
  class Entry {
   public:
    Entry(ConnectionRoster& roster, Connection& connection, std::string origin);
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;
    ~Entry();

   private:
    ConnectionRoster& roster_;
    Connection& connection_;
  };

  /// Evicts one connection for a newcomer from `origin`: of the origin with the most connections
  /// the one that is idle, else slow to end its head, else furthest behind the least rate; the one
  /// that has been so longest. Nobody has to leave for an origin with more connections than his
  /// own. False: nobody makes the server wait long enough for that.
  bool make_room(const std::string& origin);

 private:
  struct Row {
    Connection* connection;
    std::string origin;
    bool evicted;
  };

  std::mutex mutex_;
  std::vector<Row> rows_;  ///< guarded by mutex_
};

}  // namespace fairway
