#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace httplib {
class Client;
}

namespace morphodesic::tests {

/// Headless Chromium, driven by chromedriver over HTTP (WebDriver and the DevTools commands behind it).
class Browser {
public:
    /// Why there is no browser to test with; empty if there is one.
    static std::string missing();

    explicit Browser(std::filesystem::path profile);
    ~Browser();
    Browser(const Browser&) = delete;
    Browser& operator=(const Browser&) = delete;

    /// Opens a file from disk; forgets what was logged before.
    void open(const std::filesystem::path& file);
    /// Value of a JavaScript function body with `arguments`.
    nlohmann::json run(const std::string& script, const nlohmann::json& arguments = nlohmann::json::array());
    /// Runs the body until it returns something true. @return false after the given number of seconds
    bool wait_for(const std::string& script, double seconds = 30);
    nlohmann::json devtools(const std::string& command, const nlohmann::json& parameters = nlohmann::json::object());
    void click(double x, double y);
    void drag(double x, double y, double to_x, double to_y);
    void key(const std::string& name, int code);
    /// Console errors and warnings since the last call.
    std::vector<std::string> console_errors();
    /// Addresses of all requests since the last call, without data: addresses and the browser's own pages.
    std::vector<std::string> requests();

private:
    nlohmann::json post(const std::string& path, const nlohmann::json& body);
    nlohmann::json log(const std::string& type);

    std::filesystem::path profile_;
    std::unique_ptr<httplib::Client> client_;
    std::string session_;
    pid_t driver_ = -1;
    int output_ = -1;
};

}  // namespace morphodesic::tests
