#include "proto/messages/job_document.h"

#include <catch2/catch.hpp>

using namespace fairway;

TEST_CASE("times are RFC 3339 in UTC, to the millisecond") {
  CHECK(rfc3339_utc(0) == "1970-01-01T00:00:00.000Z");
  CHECK(rfc3339_utc(951825599999) == "2000-02-29T11:59:59.999Z");
  CHECK(rfc3339_utc(-1) == "1969-12-31T23:59:59.999Z");
}

TEST_CASE("a queued job's document says what is known and nothing else") {
  JobFacts job;
  job.id = "x";
  job.parameters = Json{{"steps", 3}};
  const Json document = job_document(job);
  CHECK(document["state"] == "queued");
  CHECK(document["parameters"]["steps"] == 3);
  CHECK(document["links"]["cancel"] == "/v1/jobs/x/cancel");
  CHECK(document["links"]["events"] == "/v1/jobs/x/events");
  for (const char* absent : {"started", "finished", "progress", "problem", "report", "result"}) {
    CAPTURE(absent);
    CHECK_FALSE(document.contains(absent));
  }
  CHECK_FALSE(document["links"].contains("result"));
}

TEST_CASE("an input of several files says how many") {
  JobFacts job;
  CHECK_FALSE(job_document(job)["input"].contains("files"));
  job.input.files = 3;
  CHECK(job_document(job)["input"]["files"] == 3);
}

TEST_CASE("progress is shown while a job runs only") {
  JobFacts job;
  job.progress = Progress{"flow", 2, 10, 0.3};
  CHECK_FALSE(job_document(job).contains("progress"));
  job.state = JobState::running;
  CHECK(job_document(job)["progress"]["step"] == 2);
}

TEST_CASE("a succeeded job's document leads to its result") {
  JobFacts job;
  job.id = "x";
  job.state = JobState::succeeded;
  job.result = PayloadFacts{Format::glb, 12, "ab"};
  const Json document = job_document(job);
  CHECK(document["result"]["bytes"] == 12);
  CHECK(document["result"]["media_type"] == "model/gltf-binary");
  CHECK(document["links"]["result"] == "/v1/jobs/x/result");
  CHECK_FALSE(document["links"].contains("cancel"));
}

TEST_CASE("a failed job's document carries its problem") {
  JobFacts job;
  job.state = JobState::failed;
  job.problem = Error{ErrorCode::no_triangles, "There is nothing to denoise."};
  CHECK(job_document(job)["problem"]["code"] == "no_triangles");
}
