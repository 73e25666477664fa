// The lines between fairwayd and its workers.

#include "proto/messages/worker_protocol.h"

#include <catch2/catch.hpp>

namespace fairway::test {
namespace {

std::string without_newline(std::string line) {
  REQUIRE(line.back() == '\n');
  line.pop_back();
  REQUIRE(line.find('\n') == std::string::npos);
  return line;
}

}  // namespace

TEST_CASE("an order survives the wire") {
  const WorkerOrder order{Format::drc, *parse_parameters(R"({"steps":3,"output":"glb"})")};
  const Result<WorkerOrder> back = parse_worker_order(without_newline(format_line(order)));
  REQUIRE(back);
  CHECK(back->input == Format::drc);
  CHECK(parameters_document(back->parameters) == parameters_document(order.parameters));
}

TEST_CASE("an order says how many files its input has, where there are several") {
  WorkerOrder order{Format::gltf, *parse_parameters("{}")};
  CHECK(format_line(order).find("files") == std::string::npos);
  CHECK(parse_worker_order(without_newline(format_line(order)))->files == 1);
  order.files = 16;
  const std::string line = without_newline(format_line(order));
  CHECK(parse_worker_order(line)->files == 16);
  for (const char* files : {"0", "17", "-1", "1.5", "\"2\"", "null", "[2]"}) {
    std::string lie = line;
    lie.replace(lie.rfind("16"), 2, files);
    CAPTURE(lie);
    CHECK_FALSE(parse_worker_order(lie));
  }
}

TEST_CASE("an order says where its input is only inspected") {
  WorkerOrder order{Format::ply, *parse_parameters("{}")};
  CHECK(parse_worker_order(without_newline(format_line(order)))->work == Work::denoise);
  order.work = Work::inspect;
  std::string line = without_newline(format_line(order));
  CHECK(parse_worker_order(line)->work == Work::inspect);
  line.replace(line.rfind("inspect"), 7, "explode");
  CHECK_FALSE(parse_worker_order(line));
}

TEST_CASE("an order carries its trace") {
  WorkerOrder order{Format::glb, *parse_parameters("{}")};
  CHECK(parse_worker_order(without_newline(format_line(order)))->trace.empty());
  order.trace = "0af7651916cd43dd8448eb211c80319c";
  CHECK(parse_worker_order(without_newline(format_line(order)))->trace == order.trace);
}

TEST_CASE("events survive the wire") {
  const auto round_trip = [](const WorkerEvent& event) {
    Result<WorkerEvent> back = parse_worker_event(without_newline(format_line(event)));
    REQUIRE(back);
    return *std::move(back);
  };
  const auto progress = std::get<Progress>(round_trip(Progress{"flow", 3, 100, 0.25}));
  CHECK(progress.stage == "flow");
  CHECK(progress.step == 3);
  CHECK(progress.of == 100);
  CHECK(progress.fraction == 0.25);
  const auto finished =
      std::get<Finished>(round_trip(Finished{Format::glb, {{"notes", {"a\nb"}}}}));
  CHECK(finished.output == Format::glb);
  CHECK(finished.report["notes"][0] == "a\nb");
  const auto failed = std::get<Failed>(round_trip(Failed{{ErrorCode::diverged, "No.", "/x"}}));
  CHECK(failed.error.code == ErrorCode::diverged);
  CHECK(failed.error.pointer == "/x");
}

TEST_CASE("lines that are no events are refused") {
  for (const char* line :
       {"", "warning: something", "[]", "{}", R"({"event":"dance"})",
        R"({"event":"finished","output":"exe","report":{}})", R"({"event":"failed"})"}) {
    CHECK_FALSE(parse_worker_event(line));
  }
}

}  // namespace fairway::test
