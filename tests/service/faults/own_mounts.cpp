#include "tests/service/faults/own_mounts.h"

#include <fstream>
#include <iostream>
#include <utility>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

namespace fairway::test {

bool enter_own_mounts() {
  const uid_t user = ::getuid();
  const gid_t group = ::getgid();
  if (::unshare(CLONE_NEWNS | (user == 0 ? 0 : CLONE_NEWUSER)) != 0) {
    std::cout << "SKIPPED: the kernel gives no mounts of one's own here\n";
    return false;
  }
  if (user != 0) {
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << fmt::format("{} {} 1", user, user);
    std::ofstream("/proc/self/gid_map") << fmt::format("{} {} 1", group, group);
  }
  REQUIRE(::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0);
  return true;
}

SmallDisk::SmallDisk(std::size_t bytes) {
  const std::string options = fmt::format("size={}", bytes);
  REQUIRE(::mount("none", path().c_str(), "tmpfs", 0, options.c_str()) == 0);
}

SmallDisk::~SmallDisk() {
  ::umount2(path().c_str(), MNT_DETACH);
}

ReadOnly::ReadOnly(std::filesystem::path directory) : directory_(std::move(directory)) {
  const char* const at = directory_.c_str();
  REQUIRE(::mount(at, at, nullptr, MS_BIND, nullptr) == 0);
  REQUIRE(::mount(nullptr, at, nullptr, MS_BIND | MS_REMOUNT | MS_RDONLY, nullptr) == 0);
}

ReadOnly::~ReadOnly() {
  ::umount2(directory_.c_str(), MNT_DETACH);
}

}  // namespace fairway::test
