#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace morphodesic::pipeline {

/// A prepared statement. Parameters are bound from 1 on, columns are read from 0 on, as in SQLite.
class Statement {
public:
    Statement(sqlite3* connection, std::filesystem::path file, std::string_view sql);
    ~Statement();
    Statement(Statement&& other) noexcept;
    Statement& operator=(Statement&&) = delete;

    Statement& bind(int parameter, std::string_view text);
    Statement& bind(int parameter, const char* text) { return bind(parameter, std::string_view(text)); }
    Statement& bind(int parameter, double value);  ///< NaN is stored as NULL
    Statement& bind(int parameter, long long value);
    Statement& bind(int parameter, int value) { return bind(parameter, static_cast<long long>(value)); }
    Statement& bind_blob(int parameter, std::string_view bytes);

    /// Goes to the next row; false after the last one.
    bool step();
    /// Runs a statement without rows, then makes it ready for new parameters.
    void run();
    /// Makes the statement ready for new parameters.
    void reset();

    [[nodiscard]] std::string text(int column) const;
    [[nodiscard]] double number(int column) const;  ///< NULL is NaN
    [[nodiscard]] long long integer(int column) const;
    [[nodiscard]] std::string blob(int column) const;
    [[nodiscard]] bool is_null(int column) const;

private:
    sqlite3* connection_;
    sqlite3_stmt* statement_ = nullptr;
    std::filesystem::path file_;
};

/// A connection to one SQLite file. Every failure is a StoreError that says what to do.
class Database {
public:
    /// @param writable  opens for writing (creating the file if it is not there); else read-only
    Database(std::filesystem::path file, bool writable);
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    [[nodiscard]] Statement prepare(std::string_view sql) const;
    void execute(const std::string& sql) const;
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

private:
    std::filesystem::path file_;
    sqlite3* connection_ = nullptr;
};

/// BEGIN IMMEDIATE ... COMMIT; rolls back if commit() is not reached.
class Transaction {
public:
    explicit Transaction(const Database& database) : database_(database) { database_.execute("BEGIN IMMEDIATE"); }
    ~Transaction();
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    void commit() {
        database_.execute("COMMIT");
        open_ = false;
    }

private:
    const Database& database_;
    bool open_ = true;
};

}  // namespace morphodesic::pipeline
