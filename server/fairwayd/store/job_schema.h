#pragma once

#include "core/result.h"
#include "server/fairwayd/store/sqlite.h"

namespace fairway {

/// Brings a job database to the newest schema; PRAGMA user_version says which one it has. Each step
/// is one transaction. Errors: conflict (the file is of a newer fairwayd), as Query::step().
Result<void> migrate_job_schema(Database& database);

}  // namespace fairway
