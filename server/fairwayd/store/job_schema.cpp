#include "server/fairwayd/store/job_schema.h"

#include <array>

#include <fmt/format.h>

namespace fairway {
namespace {

/// Step n brings user_version n to n + 1. Steps are only ever added.
constexpr std::array<const char*, 8> kSteps{
    R"sql(
  CREATE TABLE job (
    seq           INTEGER PRIMARY KEY AUTOINCREMENT,
    id            TEXT NOT NULL UNIQUE CHECK (length(id) = 22),
    state         TEXT NOT NULL
                  CHECK (state IN ('queued','running','succeeded','failed','canceled','expired')),
    revision      INTEGER NOT NULL CHECK (revision >= 1),
    attempt       INTEGER NOT NULL CHECK (attempt >= 1),
    fence         INTEGER NOT NULL CHECK (fence >= 0),
    lease_owner   TEXT,
    lease_until   INTEGER,
    created       INTEGER NOT NULL,
    started       INTEGER,
    finished      INTEGER,
    input_key     TEXT NOT NULL,
    input_bytes   INTEGER NOT NULL CHECK (input_bytes > 0),
    input_sha256  TEXT NOT NULL,
    input_format  TEXT NOT NULL,
    parameters    TEXT NOT NULL,
    problem       TEXT,
    report        TEXT,
    result_key    TEXT,
    result_bytes  INTEGER,
    result_sha256 TEXT,
    result_format TEXT,
    CHECK ((state = 'running') = (lease_owner IS NOT NULL)),
    CHECK ((state = 'running') = (lease_until IS NOT NULL)),
    CHECK (state NOT IN ('queued','running') OR finished IS NULL),
    CHECK (state IN ('queued','running') OR finished IS NOT NULL),
    CHECK ((state = 'succeeded') = (result_key IS NOT NULL)),
    CHECK (state <> 'failed' OR problem IS NOT NULL),
    CHECK (state IN ('failed','expired') OR problem IS NULL)
  ) STRICT;
  CREATE INDEX job_by_state ON job (state, seq);
)sql",
    R"sql(
  ALTER TABLE job ADD COLUMN input_files INTEGER NOT NULL DEFAULT 1 CHECK (input_files >= 1);
)sql",
    R"sql(
  ALTER TABLE job ADD COLUMN trace_id TEXT NOT NULL DEFAULT '';
)sql",
    R"sql(
  CREATE TABLE probe (id INTEGER PRIMARY KEY CHECK (id = 1), at INTEGER NOT NULL) STRICT;
)sql",
    // Ids of a client's own, tenants, options, expiry. SQLite changes a constraint by a new table.
    R"sql(
  CREATE TABLE tenant (
    name         TEXT NOT NULL PRIMARY KEY,
    weight       REAL NOT NULL DEFAULT 1 CHECK (weight > 0),
    most_running INTEGER CHECK (most_running >= 1),
    pass         REAL NOT NULL DEFAULT 0
  ) STRICT;
  INSERT INTO tenant (name) VALUES ('local');
  CREATE TABLE new_job (
    seq             INTEGER PRIMARY KEY AUTOINCREMENT,
    tenant          TEXT NOT NULL REFERENCES tenant (name),
    id              TEXT NOT NULL CHECK (length(id) BETWEEN 1 AND 64),
    state           TEXT NOT NULL
                    CHECK (state IN ('queued','running','succeeded','failed','canceled','expired')),
    revision        INTEGER NOT NULL CHECK (revision >= 1),
    attempt         INTEGER NOT NULL CHECK (attempt >= 1),
    fence           INTEGER NOT NULL CHECK (fence >= 0),
    lease_owner     TEXT,
    lease_until     INTEGER,
    created         INTEGER NOT NULL,
    started         INTEGER,
    finished        INTEGER,
    keep            INTEGER NOT NULL CHECK (keep > 0),
    expires         INTEGER,
    priority        INTEGER NOT NULL,
    options         TEXT NOT NULL,
    cached          INTEGER NOT NULL CHECK (cached IN (0, 1)),
    idempotency_key TEXT,
    fingerprint     TEXT NOT NULL,
    content         TEXT,
    input_key       TEXT NOT NULL,
    input_bytes     INTEGER NOT NULL CHECK (input_bytes > 0),
    input_sha256    TEXT NOT NULL,
    input_format    TEXT NOT NULL,
    input_files     INTEGER NOT NULL CHECK (input_files >= 1),
    parameters      TEXT NOT NULL,
    trace_id        TEXT NOT NULL,
    problem         TEXT,
    report          TEXT,
    result_key      TEXT,
    result_bytes    INTEGER,
    result_sha256   TEXT,
    result_format   TEXT,
    UNIQUE (tenant, id),
    UNIQUE (tenant, idempotency_key),
    CHECK ((state = 'running') = (lease_owner IS NOT NULL)),
    CHECK ((state = 'running') = (lease_until IS NOT NULL)),
    CHECK ((state IN ('queued','running')) = (finished IS NULL)),
    CHECK ((state IN ('succeeded','failed','canceled')) = (expires IS NOT NULL)),
    CHECK ((state = 'succeeded') = (result_key IS NOT NULL)),
    CHECK (state <> 'failed' OR problem IS NOT NULL),
    CHECK (state IN ('failed','expired') OR problem IS NULL)
  ) STRICT;
  INSERT INTO new_job
    SELECT seq, 'local', id, state, revision, attempt, fence, lease_owner, lease_until, created,
           started, finished, 86400000,
           CASE WHEN state IN ('succeeded','failed','canceled') THEN finished + 86400000 END,
           0, '{}', 0, NULL, '', NULL, input_key, input_bytes, input_sha256, input_format,
           input_files, parameters, trace_id, problem, report, result_key, result_bytes,
           result_sha256, result_format
    FROM job;
  DROP TABLE job;
  ALTER TABLE new_job RENAME TO job;
  CREATE INDEX job_by_state ON job (state, seq);
  CREATE INDEX job_in_turn ON job (tenant, state, priority DESC, seq);
  CREATE INDEX job_by_content ON job (tenant, content) WHERE content IS NOT NULL;
  CREATE INDEX job_by_input ON job (tenant, input_sha256);
  CREATE INDEX job_by_input_key ON job (input_key);
  CREATE INDEX job_by_result_key ON job (result_key) WHERE result_key IS NOT NULL;
  CREATE INDEX job_by_expiry ON job (expires) WHERE expires IS NOT NULL;
  CREATE TABLE job_label (
    job   INTEGER NOT NULL REFERENCES job (seq) ON DELETE CASCADE,
    label TEXT NOT NULL,
    PRIMARY KEY (label, job)
  ) STRICT, WITHOUT ROWID;
  CREATE INDEX job_label_by_job ON job_label (job);
)sql",
    R"sql(
  ALTER TABLE tenant ADD COLUMN most_queued INTEGER CHECK (most_queued >= 1);
  ALTER TABLE tenant ADD COLUMN most_bytes INTEGER CHECK (most_bytes >= 1);
  CREATE INDEX job_kept ON job (tenant, input_bytes, result_bytes) WHERE state <> 'expired';
  CREATE TABLE api_key (
    id      TEXT NOT NULL PRIMARY KEY,
    digest  TEXT NOT NULL CHECK (length(digest) = 64),
    tenant  TEXT NOT NULL REFERENCES tenant (name),
    scopes  TEXT NOT NULL,
    label   TEXT NOT NULL,
    created INTEGER NOT NULL,
    expires INTEGER,
    revoked INTEGER
  ) STRICT;
)sql",
    // What webhooks are told, and the keys that it is signed with.
    R"sql(
  CREATE TABLE webhook_delivery (
    seq         INTEGER PRIMARY KEY AUTOINCREMENT,
    id          TEXT NOT NULL UNIQUE,
    job         INTEGER NOT NULL REFERENCES job (seq) ON DELETE CASCADE,
    revision    INTEGER NOT NULL,
    tenant      TEXT NOT NULL,
    event       TEXT NOT NULL CHECK (event IN ('job.succeeded','job.failed','job.canceled')),
    url         TEXT NOT NULL,
    origin      TEXT NOT NULL,
    payload     TEXT NOT NULL,
    state       TEXT NOT NULL CHECK (state IN ('pending','delivered','dead')),
    attempt     INTEGER NOT NULL DEFAULT 0 CHECK (attempt >= 0),
    fence       INTEGER NOT NULL DEFAULT 0 CHECK (fence >= 0),
    lease_owner TEXT,
    lease_until INTEGER,
    created     INTEGER NOT NULL,
    next_at     INTEGER,
    delivered   INTEGER,
    UNIQUE (job, revision),
    CHECK ((state = 'pending') = (next_at IS NOT NULL)),
    CHECK ((state = 'delivered') = (delivered IS NOT NULL)),
    CHECK (state = 'pending' OR lease_owner IS NULL),
    CHECK ((lease_owner IS NULL) = (lease_until IS NULL))
  ) STRICT;
  CREATE INDEX webhook_delivery_due ON webhook_delivery (next_at) WHERE state = 'pending';
  CREATE TABLE webhook_attempt (
    delivery INTEGER NOT NULL REFERENCES webhook_delivery (seq) ON DELETE CASCADE,
    number   INTEGER NOT NULL,
    at       INTEGER NOT NULL,
    took     INTEGER NOT NULL,
    status   INTEGER,
    error    TEXT NOT NULL,
    PRIMARY KEY (delivery, number)
  ) STRICT, WITHOUT ROWID;
  CREATE TABLE webhook_secret (
    tenant  TEXT NOT NULL REFERENCES tenant (name) ON DELETE CASCADE,
    secret  TEXT NOT NULL,
    created INTEGER NOT NULL,
    until   INTEGER
  ) STRICT;
  CREATE UNIQUE INDEX webhook_secret_in_force ON webhook_secret (tenant) WHERE until IS NULL;
  )sql",
    // Uploads in pieces. What has become a job stays for repeated submits to be known by.
    R"sql(
  CREATE TABLE upload (
    id       TEXT NOT NULL PRIMARY KEY CHECK (length(id) = 22),
    tenant   TEXT NOT NULL REFERENCES tenant (name),
    length   INTEGER NOT NULL CHECK (length > 0),
    metadata TEXT NOT NULL,
    keep     INTEGER NOT NULL CHECK (keep > 0),
    expires  INTEGER NOT NULL,
    sha256   TEXT,
    format   TEXT,
    CHECK ((sha256 IS NULL) = (format IS NULL))
  ) STRICT;
  CREATE INDEX upload_open ON upload (tenant, length) WHERE sha256 IS NULL;
  CREATE INDEX upload_by_expiry ON upload (expires);
)sql"};

}  // namespace

Result<void> migrate_job_schema(Database& database) {
  std::int64_t version = 0;
  {
    Query query = database.query("PRAGMA user_version");
    auto row = query.step();
    if (!row) return row.error();
    version = query.integer(0);
  }
  if (version > static_cast<std::int64_t>(kSteps.size())) {
    return Error{ErrorCode::conflict,
                 fmt::format("The job database has schema {}, and this fairwayd knows up to {}: "
                             "start the newer fairwayd that wrote it.",
                             version, kSteps.size())};
  }
  for (auto step = static_cast<std::size_t>(version); step < kSteps.size(); ++step) {
    auto transaction = Transaction::begin(database);
    if (!transaction) return transaction.error();
    if (auto done = database.execute(kSteps.at(step)); !done) return done;
    if (auto done = database.execute(fmt::format("PRAGMA user_version = {}", step + 1)); !done) {
      return done;
    }
    if (auto done = transaction->commit(); !done) return done;
  }
  return {};
}

}  // namespace fairway
