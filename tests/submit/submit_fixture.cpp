#include "tests/submit/submit_fixture.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

#include <arpa/inet.h>
#include <catch2/catch.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/os/file.h"
#include "tests/places.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"

namespace fairway::test {
namespace {

namespace fs = std::filesystem;

}  // namespace

Json SubmitRun::summary() const {
  CAPTURE(output, errors);
  auto json = parse_json(output);
  REQUIRE(json);
  return *json;
}

SubmitProcess::SubmitProcess(const std::vector<std::string>& arguments,
                             const std::vector<std::string>& environment,
                             const std::string& program) {
  const auto in = open_file("/dev/null", O_RDONLY);
  const auto out = open_file(directory_.path() / "out", O_WRONLY | O_CREAT);
  const auto err = open_file(directory_.path() / "err", O_WRONLY | O_CREAT);
  REQUIRE((in && out && err));
  auto process = ChildProcess::spawn(
      {test::program(program), arguments, environment, {in->get(), out->get(), err->get()}});
  REQUIRE(process);
  process_.emplace(std::move(*process));
}

bool SubmitProcess::is_over() const {
  pollfd entry{process_->descriptor(), POLLIN, 0};
  return ::poll(&entry, 1, 0) > 0;
}

SubmitRun SubmitProcess::wait() {
  const ExitStatus status = process_->wait();
  return {status.signal == 0 ? status.code : -1, read_file(directory_.path() / "out"),
          read_file(directory_.path() / "err")};
}

std::string SubmitPlace::write(const std::string& name, const std::string& content) const {
  const fs::path path = directory_.path() / "in" / name;
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << content;
  return path.string();
}

std::vector<std::string> SubmitPlace::write_meshes(int count) const {
  std::vector<std::string> paths;
  paths.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    std::string glb = small_glb();
    // The first vertex moves along x, inside of the bounds that the file states.
    const float x = static_cast<float>(i) / 1000.0F;
    const std::size_t positions = glb.find(std::string_view("BIN\0", 4)) + 4;
    std::memcpy(glb.data() + positions, &x, sizeof x);
    paths.push_back(write(fmt::format("m{:03}.glb", i), glb));
  }
  return paths;
}

std::string SubmitPlace::result(const std::string& name) const {
  return read_file(out() / name);
}

std::vector<std::string> SubmitPlace::results() const {
  std::vector<std::string> names;
  if (!fs::exists(out())) return names;
  for (const auto& entry : fs::directory_iterator(out())) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.')) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::size_t SubmitPlace::parts() const {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(out())) {
    if (entry.path().filename().string().find("part") != std::string::npos) ++count;
  }
  return count;
}

std::string SubmitPlace::journal() const {
  return read_file(out() / ".fairway-submit.jsonl");
}

void SubmitPlace::wait_for_journal(const std::string& text, std::size_t lines) const {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  for (;;) {
    const std::string all = journal();
    std::size_t count = 0;
    for (std::size_t at = 0; (at = all.find(text, at)) != std::string::npos; ++at) ++count;
    if (count >= lines) return;
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

std::vector<std::string> SubmitPlace::arguments(std::uint16_t port, std::vector<std::string> files,
                                                const std::vector<std::string>& more) const {
  files.insert(files.end(), {"--server", fmt::format("http://127.0.0.1:{}", port), "--out",
                             out().string(), "--json"});
  files.insert(files.end(), more.begin(), more.end());
  return files;
}

SubmitRun SubmitPlace::submit(std::uint16_t port, const std::vector<std::string>& files,
                              const std::vector<std::string>& more) const {
  return SubmitProcess(arguments(port, files, more)).wait();
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::uint16_t free_port() {
  constexpr int kFirst = 20000;
  constexpr int kCount = 10000;
  for (int i = 0; i < kCount; ++i) {
    const auto port = static_cast<std::uint16_t>(kFirst + (::getpid() + i) % kCount);
    const UniqueFd socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
      return port;
    }
  }
  FAIL("no port is free");
  return 0;
}

}  // namespace fairway::test
