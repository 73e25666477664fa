#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/store/access.h"
#include "server/fairwayd/store/tenant_store.h"

namespace fairway {

/// Who asks.
struct Caller {
  std::string tenant;
  std::string key;  ///< id of the key; "" where none are asked for
};

/// Lets those in who may come in.
class Gate {
 public:
  /// `tenants`: where keys are known, null: everybody is kLocalTenant and may do all. It must
  /// outlive the gate.
  explicit Gate(TenantStore* tenants) : tenants_(tenants) {}

  /// Who sent the request; his key, `Authorization: Bearer KEY`, must have the scope. Errors:
  /// unauthorized (no key, or not a good one), forbidden (not the scope), unavailable.
  Result<Caller> admit(const HttpRequest& request, Scope scope) const;

 private:
  TenantStore* tenants_;
};

}  // namespace fairway
