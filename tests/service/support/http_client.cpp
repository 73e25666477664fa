#include "tests/service/support/http_client.h"

#include <array>
#include <cctype>

#include <arpa/inet.h>
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace fairway::test {
namespace {

constexpr time_t kPatience = 60;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

Answer answer_of(const httplib::Result& result) {
  Answer answer;
  if (!result) return answer;
  answer.status = result->status;
  answer.body = result->body;
  for (const auto& [name, value] : result->headers) answer.headers[lower(name)] = value;
  return answer;
}

httplib::Client client_of(std::uint16_t port) {
  httplib::Client client("127.0.0.1", port);
  client.set_read_timeout(kPatience);
  return client;
}

httplib::Headers to_library(const HttpClient::Headers& headers) {
  return {headers.begin(), headers.end()};
}

}  // namespace

std::string Answer::header(const std::string& lower_name) const {
  const auto found = headers.find(lower_name);
  return found == headers.end() ? "" : found->second;
}

Json Answer::json() const {
  CAPTURE(status, body);
  auto parsed = parse_json(body);
  REQUIRE(parsed);
  return *parsed;
}

std::string Answer::problem() const {
  CAPTURE(status, body);
  CHECK(header("content-type") == "application/problem+json");
  const Json document = json();
  REQUIRE(document.contains("code"));
  CHECK(document["status"] == status);
  CHECK(document["detail"].get<std::string>().size() > 10);
  return document["code"];
}

Answer HttpClient::get(const std::string& path, const Headers& headers) const {
  return answer_of(client_of(port_).Get(path, to_library(headers)));
}

Answer HttpClient::head(const std::string& path, const Headers& headers) const {
  return answer_of(client_of(port_).Head(path, to_library(headers)));
}

Answer HttpClient::remove(const std::string& path) const {
  return answer_of(client_of(port_).Delete(path));
}

Answer HttpClient::put(const std::string& path, const std::string& body, const std::string& type,
                       const Headers& headers) const {
  return answer_of(client_of(port_).Put(path, to_library(headers), body, type));
}

Answer HttpClient::post(const std::string& path, const std::string& body, const std::string& type,
                        const Headers& headers) const {
  return answer_of(client_of(port_).Post(path, to_library(headers), body, type));
}

Answer HttpClient::send(const std::string& method, const std::string& path, const Headers& headers,
                        const std::string& body) const {
  httplib::Request request;
  request.method = method;
  request.path = path;
  request.headers = to_library(headers);
  request.body = body;
  return answer_of(client_of(port_).send(request));
}

Answer HttpClient::post_form(const std::string& path, const std::string& mesh,
                             const std::string& file_name, const std::string& parameters) const {
  const httplib::MultipartFormDataItems parts = {
      {"mesh", mesh, file_name, "application/octet-stream"}, {"params", parameters, "", ""}};
  return answer_of(client_of(port_).Post(path, parts));
}

UniqueFd connect_to(std::uint16_t port, std::chrono::seconds patience) {
  UniqueFd socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  const timeval time{patience.count(), 0};
  ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &time, sizeof time);
  return socket;
}

std::string HttpClient::raw(std::string_view bytes) const {
  const UniqueFd socket = connect_to(port_, std::chrono::seconds(2));
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) break;  // refused meanwhile: the answer tells
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  std::string text;
  std::array<char, 4096> chunk;
  for (ssize_t got; (got = ::recv(socket.get(), chunk.data(), chunk.size(), 0)) > 0;) {
    text.append(chunk.data(), static_cast<std::size_t>(got));
  }
  return text;
}

std::string percent_encoded(std::string_view text) {
  std::string encoded;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    encoded += std::isalnum(u) != 0 ? std::string(1, c) : fmt::format("%{:02X}", u);
  }
  return encoded;
}

}  // namespace fairway::test
