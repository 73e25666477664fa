// Does anything that a mesh names get opened or called? Asked of the kernel, not of the program.
#include "tests/hostile/canaries.h"

#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/fairwayd/http/http_server.h"
#include "tests/hostile/access_trace.h"
#include "tests/hostile/shared_cases.h"
#include "tests/hostile/target.h"
#include "tests/hostile/wire.h"
#include "tests/places.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"

namespace fairway::hostile {
namespace {

/// A file and an address that a mesh may name; the kernel tells who reaches for them.
class Canary {
 public:
  Canary() : watch_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
    std::ofstream(path()) << std::string(4096, 'c');
    expect(::inotify_add_watch(watch_.get(), path().c_str(), IN_OPEN | IN_ACCESS) >= 0,
           "the canary cannot be watched");
    auto listener = listen_on({"127.0.0.1", 0});
    expect(static_cast<bool>(listener), "the canary cannot listen");
    listener_ = *std::move(listener);
  }

  std::string path() const { return (directory_.path() / "canary.bin").string(); }
  std::string address() const {
    return fmt::format("http://127.0.0.1:{}/canary.bin", listener_.address.port);
  }

  /// Empty where nobody came.
  std::string disturbance() const {
    if (readable(listener_.socket.get())) return "a connection was made to what the mesh names";
    if (readable(watch_.get())) return "the file that the mesh names was opened";
    return {};
  }

 private:
  static bool readable(int descriptor) {
    pollfd entry{descriptor, POLLIN, 0};
    return ::poll(&entry, 1, 0) > 0;
  }

  const test::TemporaryDirectory directory_;
  const UniqueFd watch_;
  Listener listener_;
};

std::string buffer_of(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,)"
         R"("componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36}],"images":[{"uri":")" +
         uri + R"("}],"buffers":[{"byteLength":36,"uri":")" + uri + R"("}]})";
}

std::string obj_naming(const std::string& name) {
  return "mtllib " + name + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl " + name + "\nmap_Kd " + name +
         "\nf 1 2 3\n";
}

std::string ply_naming(const std::string& name) {
  return "ply\nformat ascii 1.0\ncomment TextureFile " + name +
         "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_index\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
}

std::string stl_naming(const std::string& name) {
  return "solid " + name +
         "\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
         "vertex 0 1 0\nendloop\nendfacet\nendsolid " +
         name + "\n";
}

/// Every way a mesh can name something.
std::vector<Submit> meshes_naming(const std::string& name) {
  std::vector<Submit> out;
  const auto add = [&](const char* type, std::string body) {
    out.push_back({"/v1/jobs", type, std::move(body)});
  };
  add("model/gltf+json", buffer_of(name));
  add("model/obj", obj_naming(name));
  add("model/ply", ply_naming(name));
  add("model/stl", stl_naming(name));
  return out;
}

long status_number(pid_t pid, const std::string& field) {
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(field)) return std::stol(line.substr(field.size()));
  }
  return -1;
}

/// Whether this build's worker has a filter of system calls to show.
bool knows_sandbox() {
  std::ifstream file(test::program("fairway"), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  return bytes.find("self-test-sandbox") != std::string::npos;
}

}  // namespace

void run_canaries(Score& score) {
  score.enter("canaries");
  const Canary canary;
  Target target;
  for (const std::string& name :
       {canary.address(), canary.path(), "file://" + canary.path(),
        "../../../../../../../../.." + canary.path(), "%2e%2e/" + canary.path()}) {
    for (const Submit& each : meshes_naming(name)) {
      score.run(each.type + " naming " + name, [&] {
        const Verdict verdict = submit(target, each);
        expect(!verdict.has_server_error && verdict.outcome != "nothing",
               verdict.outcome + " " + verdict.detail);
        const std::string found = canary.disturbance();
        expect(found.empty(), found);
        const std::string trace = target.traces_of_input();
        expect(trace.empty(), trace);
      });
    }
  }
}

void run_worker_walls(Score& score) {
  score.enter("worker's walls");
  Target target({"--workers", "1"});
  const auto client = target.client();
  const std::string job = test::submit(client, test::noisy_torus(200), R"({"steps":10000})");
  test::wait_until_busy(client, job);
  const auto workers = target.workers();
  score.run("new privileges are out of reach", [&] {
    expect(!workers.empty(), "no worker is to be seen");
    for (const pid_t pid : workers) {
      expect(status_number(pid, "NoNewPrivs:") == 1, "NoNewPrivs is not set");
    }
  });
  if (knows_sandbox()) {
    score.run("a filter of system calls", [&] {
      for (const pid_t pid : workers) {
        expect(status_number(pid, "Seccomp:") == 2, "a worker at work has no filter");
      }
    });
  } else {
    score.tell("this worker has no filter of system calls: that one is there was not checked");
  }
  target.client().remove(job);
}

void run_traced_cases(Score& score, const std::vector<SharedCase>& cases) {
  score.enter("worker's accesses");
  if (!AccessTrace::is_possible()) {
    score.tell(
        "without strace the worker's file and network calls cannot be traced: "
        "only the canaries were checked");
    return;
  }
  AccessTrace trace;
  Target target({"--worker", trace.program()});
  // What a worker does for itself, whatever the mesh: libraries, the processor's facts.
  std::set<std::string> usual;
  std::string control;
  for (const SharedCase& shared : cases) {
    if (shared.category != "control" || shared.file.ends_with(".raw")) continue;
    const Verdict verdict = submit(target, *submit_of(shared, {}));
    expect(verdict.outcome == "accept", shared.file + " is not accepted under strace");
    usual.merge(trace.new_accesses());
    if (shared.file == "glb/ok_cube.glb") control = shared.bytes;
  }
  expect(!usual.empty(), "strace shows nothing of the worker");
  for (const SharedCase& shared : cases) {
    const auto request = submit_of(shared, control);
    if (!request) continue;
    score.run(shared.file, [&] {
      submit(target, *request);
      for (const std::string& access : trace.new_accesses()) {
        expect(usual.contains(access), "the worker called " + access);
      }
    });
  }
}

}  // namespace fairway::hostile
