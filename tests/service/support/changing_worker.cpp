#include "tests/service/support/changing_worker.h"

#include <filesystem>
#include <fstream>

#include <sys/stat.h>

#include "tests/places.h"

namespace fairway::test {

ChangingWorker::ChangingWorker() : ChangingWorker("exec " + program("fairway") + " \"$@\"") {}

void ChangingWorker::become(const std::string& script) const {
  const std::string next = path() + ".next";
  std::ofstream(next) << "#!/bin/sh\n" << script << "\n";
  ::chmod(next.c_str(), 0700);
  std::filesystem::rename(next, path());
}

}  // namespace fairway::test
