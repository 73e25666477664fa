#include "proto/messages/webhook_url.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

namespace fairway {
namespace {

bool is_letter_or_digit(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_url_character(char c) {
  constexpr std::string_view kMarks = "-._~:/?#[]@!$&'()*+,;=%";
  return is_letter_or_digit(c) || kMarks.find(c) != std::string_view::npos;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// The length of "http://" or "https://" in any case; 0 where the URL begins otherwise.
std::size_t scheme_length(std::string_view url) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (lower(url.substr(0, scheme.size())) == scheme) return scheme.size();
  }
  return 0;
}

std::size_t end_of_origin(std::string_view url) {
  return std::min(url.find_first_of("/?#", scheme_length(url)), url.size());
}

bool is_host(std::string_view host) {
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
    return host.find_first_not_of("0123456789abcdefABCDEF:.") == std::string_view::npos;
  }
  return !host.empty() && std::all_of(host.begin(), host.end(), [](char c) {
    return is_letter_or_digit(c) || c == '.' || c == '-' || c == '_';
  });
}

bool is_port(std::string_view text) {
  int port = 0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, port);
  return status == std::errc() && stop == end && port >= 1 && port <= 65535;
}

std::string authority_complaint(std::string_view authority) {
  if (authority.find('@') != std::string_view::npos) {
    return "must have no user name or password: put a token into its path or query";
  }
  // The colons of an IPv6 address stand in brackets.
  const std::size_t bracket = authority.find(']');
  const std::size_t colon = authority.find(':', bracket == std::string_view::npos ? 0 : bracket);
  if (!is_host(authority.substr(0, colon))) {
    return "must name a host by letters, digits, . - and _ or by an IPv6 address in brackets";
  }
  if (colon != std::string_view::npos && !is_port(authority.substr(colon + 1))) {
    return "must have a port from 1 to 65535, or none";
  }
  return {};
}

}  // namespace

std::string webhook_url_complaint(std::string_view url) {
  const std::size_t scheme = scheme_length(url);
  if (scheme == 0) return "must begin with https:// or http://";
  if (url.size() > kMaxWebhookUrlBytes) {
    return fmt::format("must have at most {} characters", kMaxWebhookUrlBytes);
  }
  if (!std::all_of(url.begin(), url.end(), is_url_character)) {
    return "must have only characters of a URL: percent-encode the others";
  }
  if (url.find('#') != std::string_view::npos) {
    return "must have no fragment: leave # and what follows it out";
  }
  return authority_complaint(url.substr(scheme, end_of_origin(url) - scheme));
}

std::string origin_of_url(std::string_view url) {
  return lower(url.substr(0, end_of_origin(url)));
}

std::string shown_url(std::string_view url) {
  const std::size_t question = url.find('?');
  if (question == std::string_view::npos) return std::string(url);
  return std::string(url.substr(0, question)) + "?…";
}

}  // namespace fairway
