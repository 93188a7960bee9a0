#include "tests/reports/browser.h"

#include <fcntl.h>
#include <httplib.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

namespace morphodesic::tests {
namespace {

using nlohmann::json;

std::string find_program(const std::vector<std::string>& names) {
    const char* path = std::getenv("PATH");
    std::string folders = path != nullptr ? path : "/usr/bin";
    for (std::size_t start = 0; start <= folders.size();) {
        const std::size_t end = std::min(folders.find(':', start), folders.size());
        for (const auto& name : names) {
            const std::string file = folders.substr(start, end - start) + "/" + name;
            if (access(file.c_str(), X_OK) == 0) return file;
        }
        start = end + 1;
    }
    return {};
}
std::string chromium() {
    return find_program({"chromium", "chromium-browser", "google-chrome"});
}

}  // namespace

std::string Browser::missing() {
    if (chromium().empty()) return "chromium is not installed (Debian: chromium)";
    if (find_program({"chromedriver"}).empty()) return "chromedriver is not installed (Debian: chromium-driver)";
    return {};
}

Browser::Browser(std::filesystem::path profile) : profile_(std::move(profile)) {
    int pipe_ends[2];
    if (pipe2(pipe_ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], 1);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    std::string program = find_program({"chromedriver"}), port_argument = "--port=0";
    char* arguments[] = {program.data(), port_argument.data(), nullptr};
    const int failed = posix_spawn(&driver_, program.c_str(), &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(pipe_ends[1]);
    output_ = pipe_ends[0];
    if (failed != 0) throw std::runtime_error("chromedriver does not start");
    std::string said;
    int port = 0;
    for (char c = 0; port == 0 && read(output_, &c, 1) == 1;) {
        said += c;
        const std::string mark = "successfully on port ";
        if (const auto at = said.find(mark); c == '\n' && at != std::string::npos)
            port = std::atoi(said.c_str() + at + mark.size());
    }
    if (port == 0) throw std::runtime_error("chromedriver does not tell its port: " + said);
    client_ = std::make_unique<httplib::Client>("127.0.0.1", port);
    client_->set_read_timeout(120);
    const json arguments_list = {"--headless",
                                 "--no-sandbox",
                                 "--disable-gpu",
                                 "--disable-quic",
                                 "--no-first-run",
                                 "--disable-background-networking",
                                 "--disable-component-update",
                                 "--disable-sync",
                                 "--disable-dev-shm-usage",
                                 "--window-size=1400,1000",
                                 "--user-data-dir=" + profile_.string(),
                                 "about:blank"};
    const json session =
        post("/session", {{"capabilities",
                           {{"alwaysMatch",
                             {{"goog:chromeOptions", {{"binary", chromium()}, {"args", arguments_list}}},
                              {"goog:loggingPrefs", {{"browser", "ALL"}, {"performance", "ALL"}}}}}}}});
    session_ = "/session/" + session["sessionId"].get<std::string>();
}

Browser::~Browser() {
    if (client_ && !session_.empty()) client_->Delete(session_);
    if (driver_ > 0) {
        kill(driver_, SIGTERM);
        waitpid(driver_, nullptr, 0);
    }
    if (output_ >= 0) close(output_);
}

json Browser::post(const std::string& path, const json& body) {
    const auto answer = client_->Post(path, body.dump(), "application/json");
    if (!answer) throw std::runtime_error("chromedriver does not answer " + path);
    const json document = json::parse(answer->body);
    if (answer->status != 200) throw std::runtime_error(path + ": " + document["value"]["message"].get<std::string>());
    return document["value"];
}

void Browser::open(const std::filesystem::path& file) {
    post(session_ + "/url", {{"url", "about:blank"}});  // the browser's own first page is not ours
    (void)console_errors();
    (void)requests();
    post(session_ + "/url", {{"url", "file://" + file.string()}});
}

json Browser::run(const std::string& script, const json& arguments) {
    return post(session_ + "/execute/sync", {{"script", script}, {"args", arguments}});
}

bool Browser::wait_for(const std::string& script, double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    do {
        const json value = run(script);
        if (!value.is_null() && value != json(false) && value != json(0) && value != json("")) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
    } while (std::chrono::steady_clock::now() < end);
    return false;
}

json Browser::devtools(const std::string& command, const json& parameters) {
    return post(session_ + "/goog/cdp/execute", {{"cmd", command}, {"params", parameters}});
}

void Browser::click(double x, double y) {
    drag(x, y, x, y);
}

void Browser::drag(double x, double y, double to_x, double to_y) {
    const auto mouse = [&](const char* type, double at_x, double at_y, int buttons) {
        devtools("Input.dispatchMouseEvent", {{"type", type},
                                              {"x", at_x},
                                              {"y", at_y},
                                              {"button", buttons >= 0 ? "left" : "none"},
                                              {"buttons", std::max(0, buttons)},
                                              {"clickCount", buttons >= 0 ? 1 : 0}});
    };
    mouse("mouseMoved", x, y, -1);
    mouse("mousePressed", x, y, 1);
    if (x != to_x || y != to_y) {
        mouse("mouseMoved", (x + to_x) / 2, (y + to_y) / 2, 1);
        mouse("mouseMoved", to_x, to_y, 1);
    }
    mouse("mouseReleased", to_x, to_y, 0);
}

void Browser::key(const std::string& name, int code) {
    for (const char* type : {"keyDown", "keyUp"}) {
        devtools("Input.dispatchKeyEvent",
                 {{"type", type}, {"key", name}, {"code", name}, {"windowsVirtualKeyCode", code}});
    }
}

json Browser::log(const std::string& type) {
    return post(session_ + "/se/log", {{"type", type}});
}

std::vector<std::string> Browser::console_errors() {
    std::vector<std::string> result;
    for (const auto& entry : log("browser")) {
        const std::string level = entry["level"];
        if (level == "SEVERE" || level == "WARNING") result.push_back(entry["message"]);
    }
    return result;
}

std::vector<std::string> Browser::requests() {
    std::vector<std::string> result;
    for (const auto& entry : log("performance")) {
        const json message = json::parse(entry["message"].get<std::string>())["message"];
        const std::string method = message["method"];
        if (method == "Network.requestWillBeSent") result.push_back(message["params"]["request"]["url"]);
        if (method == "Network.webSocketCreated") result.push_back(message["params"]["url"]);
    }
    std::erase_if(result, [](const std::string& url) {
        return url.starts_with("data:") || url.starts_with("chrome:") || url == "about:blank";
    });
    return result;
}

}  // namespace morphodesic::tests
