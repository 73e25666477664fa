// The one file that knows libcurl.

#include "server/fairwayd/webhooks/webhook_client.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <curl/curl.h>
#include <fmt/format.h>
#include <sys/socket.h>

#include "server/fairwayd/webhooks/public_address.h"

namespace fairway {
namespace {

/// What is read of an answer, head included; enough for any honest one.
constexpr std::size_t kMaxAnswerBytes = std::size_t{64} * 1024;

struct FreeHandle {
  void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
};
struct FreeList {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};

PostFailure failure_of(CURLcode code) {
  switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST:
      return PostFailure::unresolved;
    case CURLE_COULDNT_CONNECT:
      return PostFailure::unreachable;
    case CURLE_OPERATION_TIMEDOUT:
      return PostFailure::timed_out;
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_PEER_FAILED_VERIFICATION:
    case CURLE_SSL_CERTPROBLEM:
    case CURLE_SSL_CIPHER:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_SSL_ISSUER_ERROR:
    case CURLE_SSL_INVALIDCERTSTATUS:
      return PostFailure::untrusted;
    default:
      return PostFailure::broken;
  }
}

}  // namespace

std::string_view sentence_of(PostFailure failure) {
  switch (failure) {
    case PostFailure::none:
      return "";
    case PostFailure::address_refused:
      return "The host has no public address: the service does not connect to private ones.";
    case PostFailure::unresolved:
      return "The host name has no address.";
    case PostFailure::unreachable:
      return "The host refused the connection, or there is no way to it.";
    case PostFailure::timed_out:
      return "No answer came in time.";
    case PostFailure::untrusted:
      return "TLS failed: the certificate must be valid for the host and of a known authority.";
    case PostFailure::broken:
      return "The connection ended without an HTTP answer.";
  }
  return "";
}

/// One POST on its way. Stays where it is: libcurl holds its address.
struct WebhookClient::Transfer {
  std::int64_t ticket = 0;
  WebhookPost post;
  bool allow_private = false;
  bool refused = false;  ///< an address of the host was not public
  std::size_t received = 0;
  std::unique_ptr<curl_slist, FreeList> headers;
  std::unique_ptr<CURL, FreeHandle> handle;

  bool set_up(const WebhookClientOptions& options);
  PostEnd end(CURLcode code) const;

  static curl_socket_t open_socket(void* self, curlsocktype purpose, curl_sockaddr* address);
  static std::size_t receive(char* data, std::size_t size, std::size_t count, void* self);

 private:
  bool add_header(const std::string& line);
  template <class Value>
  bool set(CURLoption option, Value value) {
    return curl_easy_setopt(handle.get(), option, value) == CURLE_OK;
  }
};

/// Called with the very address that will be connected to.
curl_socket_t WebhookClient::Transfer::open_socket(void* self, curlsocktype /*purpose*/,
                                                   curl_sockaddr* address) {
  auto& transfer = *static_cast<Transfer*>(self);
  if (!transfer.allow_private && !is_public_address(address->addr)) {
    transfer.refused = true;
    return CURL_SOCKET_BAD;
  }
  return ::socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);
}

std::size_t WebhookClient::Transfer::receive(char* /*data*/, std::size_t size, std::size_t count,
                                             void* self) {
  auto& transfer = *static_cast<Transfer*>(self);
  transfer.received += size * count;
  return transfer.received <= kMaxAnswerBytes ? size * count : 0;
}

bool WebhookClient::Transfer::add_header(const std::string& line) {
  curl_slist* longer = curl_slist_append(headers.get(), line.c_str());
  if (longer == nullptr) return false;
  [[maybe_unused]] auto* same = headers.release();
  headers.reset(longer);
  return true;
}

bool WebhookClient::Transfer::set_up(const WebhookClientOptions& options) {
  handle.reset(curl_easy_init());
  if (!handle) return false;
  allow_private = options.allow_private;
  bool ok = add_header("Expect:");
  for (const auto& [name, value] : post.headers) ok = ok && add_header(name + ": " + value);
  ok = ok && set(CURLOPT_URL, post.url.c_str()) && set(CURLOPT_PROTOCOLS_STR, "http,https") &&
       set(CURLOPT_FOLLOWLOCATION, 0L) && set(CURLOPT_PROXY, "") && set(CURLOPT_NOPROXY, "*") &&
       set(CURLOPT_PATH_AS_IS, 1L) && set(CURLOPT_HTTPHEADER, headers.get()) &&
       set(CURLOPT_POSTFIELDSIZE, static_cast<long>(post.body.size())) &&
       set(CURLOPT_POSTFIELDS, post.body.c_str());
  ok = ok && set(CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_1_1)) &&
       set(CURLOPT_FORBID_REUSE, 1L) && set(CURLOPT_FRESH_CONNECT, 1L) &&
       set(CURLOPT_SSL_VERIFYPEER, 1L) && set(CURLOPT_SSL_VERIFYHOST, 2L) &&
       set(CURLOPT_SSLVERSION, static_cast<long>(CURL_SSLVERSION_TLSv1_2));
  ok = ok && set(CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(options.connect_timeout.count())) &&
       set(CURLOPT_TIMEOUT_MS, static_cast<long>(options.timeout.count())) &&
       set(CURLOPT_NOSIGNAL, 1L) &&
       // A resolver that hangs is left behind, not waited for: others are on their way, too.
       set(CURLOPT_QUICK_EXIT, 1L) && set(CURLOPT_DNS_CACHE_TIMEOUT, 0L);
  return ok && set(CURLOPT_OPENSOCKETFUNCTION, &Transfer::open_socket) &&
         set(CURLOPT_OPENSOCKETDATA, this) && set(CURLOPT_WRITEFUNCTION, &Transfer::receive) &&
         set(CURLOPT_WRITEDATA, this) && set(CURLOPT_HEADERFUNCTION, &Transfer::receive) &&
         set(CURLOPT_HEADERDATA, this) && set(CURLOPT_PRIVATE, this);
}

PostEnd WebhookClient::Transfer::end(CURLcode code) const {
  constexpr long kFirstFinalStatus = 200;
  PostEnd end;
  end.ticket = ticket;
  curl_off_t micros = 0;
  curl_easy_getinfo(handle.get(), CURLINFO_TOTAL_TIME_T, &micros);
  end.took = std::chrono::milliseconds(micros / 1000);
  long status = 0;
  curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &status);
  if (status >= kFirstFinalStatus) {
    end.status = static_cast<int>(status);
    curl_off_t seconds = 0;
    curl_easy_getinfo(handle.get(), CURLINFO_RETRY_AFTER, &seconds);
    if (seconds > 0) end.retry_after = std::chrono::seconds(seconds);
    return end;
  }
  end.failure =
      refused && code == CURLE_COULDNT_CONNECT ? PostFailure::address_refused : failure_of(code);
  return end;
}

struct WebhookClient::Library {
  Library() : multi(curl_multi_init()) {}
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    for (const auto& [ticket, transfer] : transfers) {
      curl_multi_remove_handle(multi, transfer->handle.get());
    }
    transfers.clear();
    curl_multi_cleanup(multi);
    curl_global_cleanup();
  }

  CURLM* multi;
  std::map<std::int64_t, std::unique_ptr<Transfer>> transfers;  ///< by their tickets
};

WebhookClient::WebhookClient(const WebhookClientOptions& options)
    : options_(options), library_(std::make_unique<Library>()) {}

WebhookClient::~WebhookClient() = default;

Result<std::unique_ptr<WebhookClient>> WebhookClient::create(const WebhookClientOptions& options) {
  const Error error{ErrorCode::unavailable, "libcurl cannot be used."};
  if (curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) return error;
  auto client = std::unique_ptr<WebhookClient>(new WebhookClient(options));
  if (client->library_->multi == nullptr) return error;
  return client;
}

Result<void> WebhookClient::start(std::int64_t ticket, WebhookPost post) {
  auto transfer = std::make_unique<Transfer>();
  transfer->ticket = ticket;
  transfer->post = std::move(post);
  if (!transfer->set_up(options_) ||
      curl_multi_add_handle(library_->multi, transfer->handle.get()) != CURLM_OK) {
    return Error{ErrorCode::unavailable, "libcurl refused a POST."};
  }
  library_->transfers[ticket] = std::move(transfer);
  return {};
}

std::vector<PostEnd> WebhookClient::poll(std::chrono::milliseconds time) {
  int running = 0;
  curl_multi_perform(library_->multi, &running);
  if (running > 0) {
    curl_multi_poll(library_->multi, nullptr, 0, static_cast<int>(time.count()), nullptr);
    curl_multi_perform(library_->multi, &running);
  }
  std::vector<PostEnd> ends;
  int left = 0;
  while (const CURLMsg* message = curl_multi_info_read(library_->multi, &left)) {
    if (message->msg != CURLMSG_DONE) continue;
    const CURLcode code = message->data.result;
    void* self = nullptr;
    curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &self);
    const auto* transfer = static_cast<const Transfer*>(self);
    ends.push_back(transfer->end(code));
    curl_multi_remove_handle(library_->multi, transfer->handle.get());
    library_->transfers.erase(transfer->ticket);
  }
  return ends;
}

}  // namespace fairway
