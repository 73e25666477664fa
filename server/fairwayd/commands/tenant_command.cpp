// The commands that say who may use the service.

#include "server/fairwayd/commands/tenant_command.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/stat.h>

#include "proto/messages/job_document.h"
#include "proto/messages/json.h"
#include "server/fairwayd/commands/data_words.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/sqlite_tenant_store.h"
#include "server/fairwayd/telemetry/clocks.h"

namespace fairway {
namespace {

constexpr UnixMillis kDayMillis = 86'400'000;

/// What was said on the command line; 0 or "" where nothing was.
struct Words {
  DataWords data;
  std::string tenant{kLocalTenant};
  std::string scopes = "submit,read";
  std::string label;
  std::string id;
  std::int64_t days = 0;
  double weight = 0;
  std::int64_t most_running = -1;
  std::int64_t most_queued = -1;
  std::int64_t most_bytes = -1;
  bool json = false;
};

/// The commands as CLI11 reads them.
struct CommandLine {
  CommandLine() {
    app.require_subcommand(1);
    make_keys();
    make_tenants();
  }

  CLI::App* command(CLI::App& group, const char* name, const char* help) {
    CLI::App* made = group.add_subcommand(name, help);
    words.data.add_to(*made);
    return made;
  }
  void make_keys() {
    CLI::App* keys = app.add_subcommand("keys", "Keys of the API");
    keys->require_subcommand(1);
    add = command(*keys, "add", "Make a key and print it, once");
    add->add_option("--tenant", words.tenant, "Whose jobs it is for")->capture_default_str();
    add->add_option("--scopes", words.scopes, "Any of submit, read, admin")->capture_default_str();
    add->add_option("--label", words.label, "What you call it");
    add->add_option("--days", words.days, "How long it is good; 0 = for ever")
        ->check(CLI::Range(0, 36500));
    list = command(*keys, "list", "Show all keys, without their secrets");
    list->add_flag("--json", words.json, "As JSON");
    revoke = command(*keys, "revoke", "End a key at once");
    revoke->add_option("ID", words.id, "Its id, the digits after fw_")->required();
  }
  void make_tenants() {
    CLI::App* tenants = app.add_subcommand("tenants", "Shares of the service");
    tenants->require_subcommand(1);
    show = command(*tenants, "list", "Show all tenants");
    show->add_flag("--json", words.json, "As JSON");
    set = command(*tenants, "set", "Change a tenant's share");
    set->add_option("NAME", words.tenant, "The tenant")->required();
    set->add_option("--weight", words.weight, "Turns beside others, 0.001 to 1000; new: 1")
        ->check(CLI::Range(0.001, 1000.0));
    const auto limit = [this](const char* flag, std::int64_t& to, const char* help) {
      set->add_option(flag, to, help)->check(CLI::NonNegativeNumber);
    };
    limit("--most-running", words.most_running, "Jobs at a time; 0 = any");
    limit("--most-queued", words.most_queued, "Jobs that wait; 0 = any");
    limit("--most-bytes", words.most_bytes, "Meshes kept; 0 = as --quota says");
  }

  CLI::App app{"fairwayd: who may use the service", "fairwayd"};
  Words words;
  CLI::App* add = nullptr;
  CLI::App* list = nullptr;
  CLI::App* revoke = nullptr;
  CLI::App* show = nullptr;
  CLI::App* set = nullptr;
};

/// The data directory, made where it is absent: keys may come before the service.
Result<std::filesystem::path> data_directory(const Words& words,
                                             std::span<const std::string> environment) {
  auto data = words.data.directory(environment);
  if (!data) return data.error();
  std::error_code error;
  std::filesystem::create_directories(*data, error);
  if (error) {
    return Error{ErrorCode::io, fmt::format("Cannot make the data directory {}: {}.",
                                            data->string(), error.message())};
  }
  return data;
}

std::string time_or(const std::optional<UnixMillis>& time, const char* otherwise) {
  return time ? rfc3339_utc(*time) : std::string(otherwise);
}

std::string state_of(const ApiKey& key) {
  if (key.revoked) return "revoked " + rfc3339_utc(*key.revoked);
  return key.expires && *key.expires <= wall_clock() ? "expired" : "good";
}

std::string keys_text(const std::vector<ApiKey>& keys) {
  std::string text;
  for (const ApiKey& key : keys) {
    text += fmt::format("{}  {}  {}  {}  until {}  {}\n", key.id, key.tenant, to_string(key.scopes),
                        state_of(key), time_or(key.expires, "revoked"), key.label);
  }
  return text.empty() ? "There is no key yet: fairwayd keys add makes one.\n" : text;
}

Json keys_json(const std::vector<ApiKey>& keys) {
  Json list = Json::array();
  for (const ApiKey& key : keys) {
    Json entry{{"id", key.id},
               {"tenant", key.tenant},
               {"scopes", to_string(key.scopes)},
               {"label", key.label},
               {"created", rfc3339_utc(key.created)}};
    if (key.expires) entry["expires"] = rfc3339_utc(*key.expires);
    if (key.revoked) entry["revoked"] = rfc3339_utc(*key.revoked);
    list.push_back(std::move(entry));
  }
  return list;
}

Json tenants_json(const std::vector<Tenant>& tenants) {
  Json list = Json::array();
  for (const Tenant& tenant : tenants) {
    Json entry{{"name", tenant.name}, {"weight", tenant.weight}};
    if (tenant.most_running) entry["most_running"] = *tenant.most_running;
    if (tenant.most_queued) entry["most_queued"] = *tenant.most_queued;
    if (tenant.most_bytes) entry["most_bytes"] = *tenant.most_bytes;
    list.push_back(std::move(entry));
  }
  return list;
}

std::string tenants_text(const std::vector<Tenant>& tenants) {
  const auto limit = [](const std::optional<std::int64_t>& number) {
    return number ? fmt::to_string(*number) : std::string("any");
  };
  std::string text;
  for (const Tenant& tenant : tenants) {
    text += fmt::format("{}  weight {}  running {}  queued {}  bytes {}\n", tenant.name,
                        tenant.weight, limit(tenant.most_running), limit(tenant.most_queued),
                        limit(tenant.most_bytes));
  }
  return text;
}

Result<std::string> add_key(TenantStore& store, const Words& words) {
  auto scopes = parse_scopes(words.scopes);
  if (!scopes) return scopes.error();
  NewKey key{words.tenant, *scopes, words.label, {}};
  if (words.days > 0) key.expires = wall_clock() + words.days * kDayMillis;
  auto text = store.add_key(key);
  if (!text) return text;
  return *text + "\n";
}

/// Leaves as it is what was not said, and takes 0 for no limit.
void change(std::optional<std::int64_t>& limit, std::int64_t said) {
  if (said >= 0) limit = said == 0 ? std::nullopt : std::optional(said);
}

Result<std::string> set_tenant(TenantStore& store, const Words& words) {
  const auto tenants = store.tenants();
  if (!tenants) return tenants.error();
  const auto found = std::find_if(tenants->begin(), tenants->end(),
                                  [&](const Tenant& each) { return each.name == words.tenant; });
  Tenant tenant;
  if (found != tenants->end()) tenant = *found;
  tenant.name = words.tenant;
  if (words.weight > 0) tenant.weight = words.weight;
  change(tenant.most_running, words.most_running);
  change(tenant.most_queued, words.most_queued);
  change(tenant.most_bytes, words.most_bytes);
  if (auto done = store.set_tenant(tenant); !done) return done.error();
  return tenants_text({tenant});
}

Result<std::string> run(const CommandLine& line, TenantStore& store) {
  const Words& words = line.words;
  if (line.add->parsed()) return add_key(store, words);
  if (line.set->parsed()) return set_tenant(store, words);
  if (line.revoke->parsed()) {
    const auto key = store.revoke_key(words.id);
    if (!key) return key.error();
    return keys_text({*key});
  }
  if (line.list->parsed()) {
    const auto keys = store.keys();
    if (!keys) return keys.error();
    return words.json ? dump_json(keys_json(*keys)) + "\n" : keys_text(*keys);
  }
  const auto tenants = store.tenants();
  if (!tenants) return tenants.error();
  return words.json ? dump_json(tenants_json(*tenants)) + "\n" : tenants_text(*tenants);
}

}  // namespace

bool is_tenant_command(std::span<const char* const> arguments) {
  if (arguments.empty()) return false;
  const std::string_view first = arguments.front();
  return first == "keys" || first == "tenants";
}

Result<std::string> run_tenant_command(std::span<const char* const> arguments,
                                       std::span<const std::string> environment) {
  CommandLine line;
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    line.app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    return line.app.help();
  } catch (const CLI::ParseError& e) {
    return Error{ErrorCode::usage, std::string(e.what()) + ". See --help."};
  }
  ::umask(077);
  const auto data = data_directory(line.words, environment);
  if (!data) return data.error();
  auto store = SqliteTenantStore::open(*data / "jobs.sqlite");
  if (!store) return store.error();
  return run(line, **store);
}

}  // namespace fairway
