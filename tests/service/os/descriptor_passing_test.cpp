#include "server/os/descriptor_passing.h"

#include <array>
#include <string>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <sys/stat.h>

#include "server/os/child_process.h"

using namespace fairway;

namespace {

ino_t inode_of(int fd) {
  struct stat status = {};
  REQUIRE(::fstat(fd, &status) == 0);
  return status.st_ino;
}

}  // namespace

TEST_CASE("descriptors arrive with the first bytes, in order, and close on exec") {
  auto ends = socket_pair();
  REQUIRE(ends);
  const UniqueFd null(::open("/dev/null", O_RDONLY));
  const UniqueFd zero(::open("/dev/zero", O_RDONLY));
  const std::array given{null.get(), zero.get()};
  REQUIRE(send_with_descriptors(ends->first.get(), std::string_view("order\n"), given));
  const auto passed = receive_with_descriptors(ends->second.get());
  REQUIRE(passed);
  CHECK(passed->bytes == "order\n");
  REQUIRE(passed->descriptors.size() == 2);
  CHECK(inode_of(passed->descriptors[0].get()) == inode_of(null.get()));
  CHECK(inode_of(passed->descriptors[1].get()) == inode_of(zero.get()));
  CHECK(::fcntl(passed->descriptors[0].get(), F_GETFD) == FD_CLOEXEC);
}

TEST_CASE("a message without descriptors brings none, and an end no bytes") {
  auto ends = socket_pair();
  REQUIRE(ends);
  REQUIRE(send_with_descriptors(ends->first.get(), std::string_view("x"), {}));
  const auto passed = receive_with_descriptors(ends->second.get());
  REQUIRE(passed);
  CHECK(passed->bytes == "x");
  CHECK(passed->descriptors.empty());
  ends->first.reset();
  const auto end = receive_with_descriptors(ends->second.get());
  REQUIRE(end);
  CHECK(end->bytes.empty());
  CHECK_FALSE(send_with_descriptors(ends->second.get(), std::string_view("x"), {}));
}
