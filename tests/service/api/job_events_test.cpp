// The stream of one job's events over a real store, without sockets.
#include "server/fairwayd/api/job_events.h"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/service/support/job_fixture.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

Progress at_step(int step) {
  return {"flow", step, 100, step / 100.0};
}

/// The stream of f's job; `on_text` sees every text that is sent and says whether to go on.
void follow(test::JobFixture& f, std::optional<std::int64_t> seen, EventPace pace,
            const BodySink& on_text) {
  const auto document = [&f](const Job& job) {
    Json json{{"state", name_of(job.state)}};
    if (const auto progress = f.board.progress(job.number)) {
      json["progress"] = Json{{"step", progress->step}};
    }
    return json;
  };
  JobEvents(f.watch(), document, seen, pace).send(f.number(), on_text);
}

const std::string kComment = ":\n\n";

}  // namespace

TEST_CASE("an event has a line for each line of its data") {
  CHECK(event_text("state", "5", "{}") == "event: state\nid: 5\ndata: {}\n\n");
  CHECK(event_text("progress", "", "a\nb") == "event: progress\ndata: a\ndata: b\n\n");
}

TEST_CASE("a stream tells every state with its revision, and ends after the final one") {
  test::JobFixture f;
  std::vector<std::string> texts;
  follow(f, std::nullopt, {}, [&](std::string_view text) {
    texts.emplace_back(text);
    if (texts.size() == 2) f.start();
    if (texts.size() == 3) f.cancel();
    f.board.announce();
    return true;
  });
  const std::vector<std::string> expected = {
      kComment, "event: state\nid: 1\ndata: {\"state\":\"queued\"}\n\n",
      "event: state\nid: 2\ndata: {\"state\":\"running\"}\n\n",
      "event: state\nid: 3\ndata: {\"state\":\"canceled\"}\n\n"};
  CHECK(texts == expected);
}

TEST_CASE("a state that the client has seen is not told again") {
  test::JobFixture f;
  f.start();
  std::vector<std::string> texts;
  follow(f, 2, {1ms, 20ms}, [&](std::string_view text) {
    texts.emplace_back(text);
    if (texts.size() == 2) f.cancel();
    return true;
  });
  REQUIRE(texts.size() >= 3);
  CHECK(texts[1] == kComment);
  CHECK(texts.back().starts_with("event: state\nid: 3\n"));
  for (const std::string& text : texts) CHECK(text.find("id: 2") == std::string::npos);
}

TEST_CASE("progress is told as it grows, without an id, and never twice") {
  test::JobFixture f;
  f.start();
  std::vector<std::string> texts;
  int step = 0;
  follow(f, std::nullopt, {1ms, 10s}, [&](std::string_view text) {
    texts.emplace_back(text);
    if (++step == 5) {
      f.cancel();
      f.board.announce();
    } else {
      f.board.post(f.number(), at_step(step));
    }
    return true;
  });
  const std::vector<std::string> expected = {
      kComment,
      "event: state\nid: 2\ndata: {\"state\":\"running\",\"progress\":{\"step\":1}}\n\n",
      "event: progress\ndata: {\"step\":2}\n\n",
      "event: progress\ndata: {\"step\":3}\n\n",
      "event: progress\ndata: {\"step\":4}\n\n",
      "event: state\nid: 3\ndata: {\"state\":\"canceled\",\"progress\":{\"step\":4}}\n\n"};
  CHECK(texts == expected);
}

TEST_CASE("progress comes no more often than its pace") {
  test::JobFixture f;
  f.start();
  int progress = 0;
  int beats = 0;
  follow(f, std::nullopt, {1h, 5ms}, [&](std::string_view text) {
    if (text.starts_with("event: progress")) ++progress;
    if (text == kComment) f.board.post(f.number(), at_step(++beats));
    if (beats == 20) f.cancel();
    return true;
  });
  CHECK(progress <= 1);
}

TEST_CASE("a stream ends when nobody takes it, the client is gone or the server stops") {
  test::JobFixture f;
  int texts = 0;
  follow(f, std::nullopt, {}, [&](std::string_view) { return ++texts < 1; });
  CHECK(texts == 1);
  follow(f, std::nullopt, {}, [&](std::string_view) {
    f.client_is_there = false;
    return true;
  });
  f.client_is_there = true;
  follow(f, std::nullopt, {}, [&](std::string_view) {
    f.stop.request_stop();
    return true;
  });
  SUCCEED("all three ended");
}
