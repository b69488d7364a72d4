#include "live/live_view.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "live/live_run.h"
#include "tools/page_data.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

OrganizedCloud ring(float radius_m, int columns) {
  OrganizedCloud cloud(1, columns);
  for (int column = 0; column < columns; ++column) {
    const float a = 6.2831853F * static_cast<float>(column) / static_cast<float>(columns);
    cloud.points_m[column] = {radius_m * std::cos(a), radius_m * std::sin(a), 0.0F};
    cloud.range_m[column] = radius_m;
  }
  return cloud;
}

/// What the view answers to "/state" or "/view".
nlohmann::json answered(const LiveView& view, const std::string& target) {
  const ViewAnswer answer = view.answer(target);
  CHECK(answer.status == 200);
  return nlohmann::json::parse(answer.body);
}

FileDescriptor connection_to(const std::string& url) {
  FileDescriptor connection(socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))));
  REQUIRE(connect(connection.get(), reinterpret_cast<sockaddr*>(&to), sizeof to) == 0);
  return connection;
}

const std::string kRequest = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";

/// What a server answers to these bytes.
std::string answer_to(const std::string& url, const std::string& request) {
  const FileDescriptor connection = connection_to(url);
  send(connection.get(), request.data(), request.size(), MSG_NOSIGNAL);
  std::string answer;
  std::array<char, 1024> part{};
  while (true) {
    const ssize_t bytes = recv(connection.get(), part.data(), part.size(), 0);
    if (bytes <= 0) return answer;
    answer.append(part.data(), static_cast<std::size_t>(bytes));
  }
}

}  // namespace

TEST_CASE("the live map keeps one point per voxel, and coarser ones instead of too many") {
  LiveMap map;
  map.add({0.01F, 0.01F, 0.01F}, {});
  map.add({0.02F, 0.02F, 0.02F}, {});
  map.add({-0.01F, 0.02F, 0.02F}, {});
  map.add({std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F}, {});
  map.add({1e9F, 0.0F, 0.0F}, {});
  CHECK(map.points_m().size() == 2);
  for (int i = 0; i < 600; ++i) {
    for (int k = 0; k < 600; ++k) {
      map.add({0.3F * static_cast<float>(i), 0.3F * static_cast<float>(k), 0.0F}, {});
    }
  }
  CHECK(map.points_m().size() < LiveMap::kMostPoints);
  CHECK(map.points_m().size() > LiveMap::kMostPoints / 10);
  CHECK(map.voxel_m() > LiveMap::kFirstVoxel_m);
  // Nothing of the area is missing.
  std::array<int, 9> ninths{};
  for (const Eigen::Vector3f& p : map.points_m()) {
    ++ninths[3 * static_cast<int>(p.x() / 60.01F) + static_cast<int>(p.y() / 60.01F)];
  }
  for (const int points : ninths) CHECK(points > static_cast<int>(map.points_m().size()) / 12);
}

TEST_CASE("the state has the pose and the numbers, the view all points, also after a loop") {
  LiveView view("a title");
  view.add(ring(10.0F, 64), Pose::Identity(), 0);
  Pose moved(Eigen::Translation3d(2.0, 0.0, 0.0));
  view.add(ring(10.0F, 64), moved, 0);
  LiveStatus status{10.0, 2, 9.5, 0.031, ScanRecord{}, 2.0, 2, {}, {}};
  status.counts.packets.lost = 7;
  status.counts.dropped_scans = 1;
  view.set(status);
  const auto state = answered(view, "/state");
  CHECK(state["position_m"] == nlohmann::json({2.0, 0.0, 0.0}));
  CHECK(state["latency_ms"] == 31.0);
  CHECK(!answered(LiveView("no scan yet"), "/state").contains("latency_ms"));
  CHECK(state["lost_packets"] == 7);
  CHECK(state["dropped_scans"] == 1);
  CHECK(state["mapping"] == "ok");
  CHECK(holds(state["warning"].get<std::string>(), "2 submaps, relative pose unknown"));
  CHECK(answered(view, "/view")["paths"][0]["pieces"] ==
        nlohmann::json({{{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}}));
  moved.translation().y() = 1.0;
  view.replace({{0.0, Pose::Identity()}, {0.1, moved}}, {0, 0});
  const auto after = answered(view, "/view");
  CHECK(after["paths"][0]["pieces"][0][1] == nlohmann::json({2.0, 1.0, 0.0}));
  CHECK(after["clouds"][0]["points"].get<std::string>().size() == 2 * 16 * 16 / 3 + 2);
  for (const char* target : {"/state?x=99999999999999999999999", "/state?&&&==", "/view?%00"}) {
    CHECK(answered(view, target).is_object());
  }
  CHECK(view.answer("/../etc/passwd").status == 404);
  status = {};
  status.counts.trouble = "another form";  // why the packets that come make no scans
  view.set(status);
  CHECK(answered(view, "/state")["warning"] == "another form");
}

TEST_CASE("the view that turns shows the map, the last scan and a path of bounded size") {
  LiveView view("<a>");
  const auto data = [&] { return answered(view, "/view"); };
  CHECK(data()["clouds"][0]["blocks"].empty());  // before the first scan
  Pose pose = Pose::Identity();
  for (int i = 0; i < 15'000; ++i) {
    pose.translation().x() = 0.2 * i;
    view.add(ring(10.0F, 64), pose, 0);
  }
  const auto now = data();
  CHECK(now["paths"][0]["pieces"][0].size() < 2'100);
  CHECK(now["paths"][0]["pieces"][0].size() > 500);
  CHECK(now["paths"][0]["pieces"][0][0][0] == 0.0);
  CHECK(now["paths"][0]["pieces"][0].back()[0] == doctest::Approx(0.2 * 14'999));
  CHECK(now["scans"][0]["at"][0] == now["paths"][0]["pieces"][0].back()[0]);
  CHECK_FALSE(now["clouds"][0]["blocks"].empty());
  CHECK_FALSE(now["scans"][0]["measured"]["blocks"].empty());
  CHECK(now.dump().size() < 1'000'000);
}

TEST_CASE("a path whose parts are not joined is not drawn as if they were") {
  LiveView view("");
  Pose pose = Pose::Identity();
  for (int i = 0; i < 20; ++i) {
    pose.translation().x() = i;
    view.add(OrganizedCloud(1, 1), pose, i < 15 ? 0 : 4);
  }
  CHECK(answered(view, "/state")["segment"] == 4);
  const auto path = answered(view, "/view")["paths"][0]["pieces"];
  REQUIRE(path.size() == 2);
  CHECK(path[0].size() == 15);
  CHECK(path[1][0][0] == 15.0);
}

TEST_CASE("the view that turns has intensities where the sensor gives them, also after a loop") {
  LiveView view("");
  const auto bright = [&] { return answered(view, "/view")["clouds"][0]["bright"]; };
  OrganizedCloud cloud = ring(10.0F, 64);
  view.add(cloud, Pose::Identity(), 0);
  CHECK(bright().empty());
  cloud.intensity.assign(64, 7.0F);
  const Pose moved(Eigen::Translation3d(2.0, 0.0, 0.0));
  view.add(cloud, moved, 0);
  CHECK(bright() == nlohmann::json({7.0, 7.0}));
  view.replace({{0.0, Pose::Identity()}, {0.1, moved}}, {0, 0});
  CHECK(bright() == nlohmann::json({7.0, 7.0}));
}

TEST_CASE("the server answers GET, and refuses or leaves everything else") {
  const ViewServer server("127.0.0.1", 0, [](const std::string& target) {
    return target == "/a?b=1" ? ViewAnswer{200, "text/plain", "hello"}
                              : ViewAnswer{404, "text/plain", ""};
  });
  const std::string url = server.url();
  const std::string host = " HTTP/1.1\r\nHost: 127.0.0.1:8642\r\n\r\n";
  const std::string hello = answer_to(url, "GET /a?b=1" + host);
  CHECK(hello.starts_with("HTTP/1.1 200 OK\r\n"));
  CHECK(hello.ends_with("\r\n\r\nhello"));
  CHECK(answer_to(url, "GET /b" + host).starts_with("HTTP/1.1 404"));
  CHECK(answer_to(url, "POST /a" + host).starts_with("HTTP/1.1 400"));
  CHECK(answer_to(url, "GET\r\n\r\n").starts_with("HTTP/1.1 400"));
  CHECK(answer_to(url, "GET /\r\n\r\n").starts_with("HTTP/1.1 400"));
  answer_to(url, std::string(100'000, 'x'));
  const auto start = std::chrono::steady_clock::now();
  answer_to(url, "GET /a");  // and then nothing
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
  CHECK(answer_to(url, "GET /a?b=1" + host).ends_with("hello"));
}

TEST_CASE("a page of another site, whose name resolves to this host, gets no data") {
  const ViewServer server("127.0.0.1", 0, [](const std::string&) {
    return ViewAnswer{200, "text/plain", "where you are"};
  });
  for (const char* host : {"evil.example", "evil.example:8642", "127.0.0.1.evil.example", ""}) {
    CAPTURE(host);
    const std::string answer =
        answer_to(server.url(), fmt::format("GET / HTTP/1.1\r\nHost: {}\r\n\r\n", host));
    CHECK(answer.starts_with("HTTP/1.1 403"));
    CHECK_FALSE(holds(answer, "where you are"));
  }
  CHECK(answer_to(server.url(), "GET / HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 403"));
  for (const char* host : {"localhost:1", "LOCALHOST", "192.168.1.7:8642", "[::1]:8642"}) {
    CAPTURE(host);
    CHECK(is_own_host(host));
  }
}

TEST_CASE("clients that send nothing, or do not read, block no other client") {
  const ViewServer server("127.0.0.1", 0, [](const std::string&) {
    return ViewAnswer{200, "text/plain", std::string(1'000'000, 'x')};
  });
  std::vector<FileDescriptor> silent;
  for (std::size_t i = 0; i < 2 * ViewServer::kMostConnections; ++i) {
    silent.push_back(connection_to(server.url()));
    if (i % 2 == 0) continue;  // half of them ask and do not read
    send(silent.back().get(), kRequest.data(), kRequest.size(), MSG_NOSIGNAL);
  }
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 3; ++i) CHECK(answer_to(server.url(), kRequest).size() > 1'000'000);
  // One after the other, with two seconds for each, they would take two minutes.
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
}

TEST_CASE("a port in use and an invalid address are refused in one line") {
  const auto nothing = [](const std::string&) { return ViewAnswer(); };
  const ViewServer server("127.0.0.1", 0, nothing);
  const std::string url = server.url();
  const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  CHECK(refused_with([&] { ViewServer("127.0.0.1", port, nothing); }, std::to_string(port),
                     "--view"));
  CHECK(refused_with([&] { ViewServer("localhost", 0, nothing); }, "localhost", "127.0.0.1"));
}

TEST_CASE("the line of a second has pose, rate, latency and losses, and more only if there is") {
  LiveStatus status;
  status.elapsed_s = 12.2;
  CHECK(status_line(status) == "12 s  0 scans  0.0 scans/s  0 packets lost  0 scans dropped");
  ScanRecord record;
  record.report.T_map_sensor.translation() = Eigen::Vector3d(3.214, -0.4, 0.02);
  status.latest = record;
  status.scans = 120;
  status.rate_hz = 9.96;
  status.latency_s = 0.0234;
  status.counts.packets.lost = 3;
  status.counts.dropped_scans = 1;
  CHECK(status_line(status) ==
        "12 s  120 scans  x 3.21 y -0.40 z 0.02 m  10.0 scans/s  latency 23 ms  3 packets lost  1 "
        "scans dropped");
  status.latest->report.mapping_status = slam::Status::kDegenerate;
  status.counts.other_senders = 2;
  CHECK(holds(status_line(status), "mapping degenerate"));
  CHECK(status_line(status).ends_with("  2 packets of other senders"));
  status.submaps = 2;
  CHECK(status_line(status).ends_with("  2 submaps, not joined"));
  status.counts.recording_failure = "a.pcap: cannot be written; is the disk full?";
  CHECK(status_line(status).ends_with("  NOT RECORDED ANY MORE"));
  status.results_failure = "out: cannot be written; is the disk full?";
  CHECK(status_line(status).ends_with("  RESULTS NOT WRITTEN"));
}

}  // namespace hqslam::tools
