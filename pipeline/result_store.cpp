#include "pipeline/result_store.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "pipeline/database.h"
#include "pipeline/digest.h"
#include "pipeline/study_folder.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int application_id = 0x6d6f7270;  // "morp" in the file's header

constexpr char schema[] = R"(
CREATE TABLE study(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE shapes(name TEXT PRIMARY KEY, path TEXT NOT NULL, label TEXT NOT NULL, dimension INTEGER NOT NULL,
  file_digest TEXT NOT NULL, reading TEXT NOT NULL, placing TEXT NOT NULL, extent_radius REAL, content_digest TEXT NOT NULL, volume REAL, scale REAL,
  notes TEXT NOT NULL, problem TEXT NOT NULL, fullness REAL);
CREATE TABLE level_sets(digest TEXT PRIMARY KEY, dimension INTEGER NOT NULL, level INTEGER NOT NULL,
  u BLOB NOT NULL, mask BLOB NOT NULL, checksum TEXT NOT NULL);
CREATE TABLE settings(hash TEXT PRIMARY KEY, text TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE geodesics(a TEXT NOT NULL, b TEXT NOT NULL, settings TEXT NOT NULL,
  failure TEXT NOT NULL, termination TEXT NOT NULL, path_length REAL, path_energy REAL, total_energy REAL, error REAL,
  extrapolated_length REAL, min_det REAL, seconds REAL, details TEXT NOT NULL, checksum TEXT NOT NULL,
  PRIMARY KEY(settings, a, b)) WITHOUT ROWID;
CREATE TABLE pictures(key TEXT PRIMARY KEY, bytes BLOB NOT NULL);
)";

constexpr const char* tables[] = {"study", "shapes", "level_sets", "settings", "geodesics", "pictures"};

constexpr const char* shape_count = "shape_count";   // fact
constexpr const char* fullness_column = "fullness";  // a column that the first studies do not have

/// Goes behind the placing of a shape: a changed bit anywhere in its row has the file read again.
/// @param with_label  also over class and dimension, which the first studies did not seal
std::string shape_seal(const StoredShape& shape, const std::string& notes, bool with_label = true) {
    std::string bytes;
    for (const std::string* text : {&shape.name, &shape.file_digest, &shape.reading, &shape.placing,
                                    &shape.content_digest, &notes, &shape.problem}) {
        bytes += *text + '\n';
    }
    if (with_label) bytes += shape.label + '\n' + std::to_string(shape.dimension) + '\n';
    const auto append = [&](double x) {
        const double canonical = std::isnan(x) ? 0.0 : x;
        bytes.append(reinterpret_cast<const char*>(&canonical), sizeof canonical);
    };
    for (const double x : {shape.extent_radius, shape.volume, shape.scale}) append(x);
    if (shape.fullness > 0.0) append(shape.fullness);  // earlier studies did not measure it
    return digest(bytes);
}

std::string compress(const std::vector<double>& values) {
    const std::vector<float> floats(values.begin(), values.end());
    const auto size = static_cast<uLong>(floats.size() * sizeof(float));
    uLongf packed = compressBound(size);
    std::string bytes(packed, '\0');
    compress2(reinterpret_cast<Bytef*>(bytes.data()), &packed, reinterpret_cast<const Bytef*>(floats.data()), size, 1);
    bytes.resize(packed);
    return bytes;
}

std::vector<double> uncompress(const std::string& bytes, std::size_t count) {
    std::vector<float> floats(count);
    auto size = static_cast<uLongf>(count * sizeof(float));
    if (::uncompress(reinterpret_cast<Bytef*>(floats.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                     static_cast<uLong>(bytes.size())) != Z_OK ||
        size != count * sizeof(float)) {
        return {};
    }
    return {floats.begin(), floats.end()};
}

}  // namespace

struct ResultStore::Impl {
    Impl(fs::path file, Access access)
        : database(std::move(file), access == Access::write), repairs(access == Access::write) {}

    void open(Access access) {
        const int version = static_cast<int>(pragma("user_version"));
        if (version == 0 && access == Access::write && pragma("schema_version") == 0) {
            Transaction transaction(database);
            database.execute(schema);
            database.execute("PRAGMA application_id = " + std::to_string(application_id));
            database.execute("PRAGMA user_version = " + std::to_string(store_version));
            transaction.commit();
        } else if (version == 0 || pragma("application_id") != application_id) {
            throw StoreError(database.file(), "is not the store of a morphodesic study; use another folder");
        } else if (version != store_version) {
            throw StoreError(database.file(),
                             "was written by " + std::string(version > store_version ? "a newer" : "an older") +
                                 " morphodesic (store version " + std::to_string(version) + ", this program reads " +
                                 std::to_string(store_version) +
                                 "); use that program, or make a new study: morphodesic run FOLDER --out STUDY");
        }
        if (access == Access::write) {
            // Each commit is on the disk before the next pair is reported as done: a power cut, too, loses only the
            // pairs in flight. It costs milliseconds, a pair far more.
            database.execute("PRAGMA synchronous = FULL");
            database.execute("PRAGMA wal_autocheckpoint = 1000");
        }
        if (access != Access::glance) expect_sound();
        expect_tables();
        if (access != Access::write) return;
        database.execute("PRAGMA journal_mode = WAL");  // a copy may have lost that
        if (!has_fullness()) {
            database.execute("ALTER TABLE shapes ADD COLUMN " + std::string(fullness_column) + " REAL");
        }
    }
    void expect_sound() const {
        // Not quick_check: it does not see that keys of a tree are out of order, and a search in such a tree misses
        // rows that are there. The whole check takes 1.8 times as long (1.8 s for 300,000 pairs).
        Statement check = database.prepare("PRAGMA integrity_check(1)");
        if (check.step() && check.text(0) != "ok") {
            // Not .recover: with the sqlite3 of Debian 12 it fails at once, and saved.sqlite would be empty. A dump
            // lacks the numbers in the header, and may have rows of a broken table twice.
            throw StoreError(
                database.file(),
                "is damaged (" + check.text(0) +
                    "); restore a copy, or keep what is sound with: sqlite3 study.sqlite .dump | sed -e '$a PRAGMA "
                    "application_id=" +
                    std::to_string(application_id) + ";PRAGMA user_version=" + std::to_string(store_version) +
                    ";COMMIT;' -e '/^COMMIT/d;/^ROLLBACK/d;s/^INSERT /INSERT OR IGNORE /' | sqlite3 saved.sqlite && "
                    "mv study.sqlite damaged.sqlite && rm -f study.sqlite-wal study.sqlite-shm && mv saved.sqlite "
                    "study.sqlite; then give the same command again. Or move it away: everything is computed again");
        }
    }
    void expect_tables() const {
        Statement find = database.prepare("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?");
        for (const char* table : tables) {
            if (!find.bind(1, table).step()) {
                throw StoreError(database.file(),
                                 "is damaged (its table " + std::string(table) +
                                     " is missing); restore a copy, or move it away and give the "
                                     "command that made the study again: everything is computed again");
            }
            find.reset();
        }
    }
    [[nodiscard]] bool has_fullness() const {
        Statement find = database.prepare("SELECT 1 FROM pragma_table_info('shapes') WHERE name = ?");
        return find.bind(1, fullness_column).step();
    }
    /// The caller holds the mutex.
    void put_geodesic(const StoredGeodesic& g) const {
        const std::string details = details_of(g);
        Statement s =
            database.prepare("INSERT OR REPLACE INTO geodesics VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
        s.bind(1, g.a).bind(2, g.b).bind(3, g.settings_hash).bind(4, g.failure).bind(5, to_string(g.termination));
        int column = 6;
        for (const auto number : row_numbers) s.bind(column++, g.*number);
        s.bind(13, details);
        s.bind(14, row_checksum(g, details)).run();
    }
    /// The caller holds the mutex.
    void set_fact(std::string_view key, std::string_view value) const {
        Statement s = database.prepare("INSERT OR REPLACE INTO study VALUES(?1, ?2), ('seal of ' || ?1, ?3)");
        s.bind(1, key).bind(2, value).bind(3, digest(value)).run();
    }
    [[nodiscard]] long shapes_there() const {
        Statement count = database.prepare("SELECT count(*) FROM shapes");
        return count.step() ? static_cast<long>(count.integer(0)) : 0;
    }
    [[nodiscard]] long long pragma(const std::string& name) const {
        Statement statement = database.prepare("PRAGMA " + name);
        return statement.step() ? statement.integer(0) : 0;
    }
    /// Reads the columns of `SELECT * FROM geodesics`; false if the row is damaged.
    [[nodiscard]] std::pair<StoredGeodesic, bool> row(const Statement& s) const {
        StoredGeodesic g;
        g.a = s.text(0);
        g.b = s.text(1);
        g.settings_hash = s.text(2);
        g.failure = s.text(3);
        g.termination = termination_from(s.text(4));
        int column = 5;
        for (const auto number : row_numbers) g.*number = s.number(column++);
        const std::string details = s.text(12);
        if (row_checksum(g, details) != s.text(13)) {
            return {g, false};
        }
        read_details(details, g);
        return {g, true};
    }

    Database database;
    bool repairs;  // a process that writes makes damaged facts anew; one that only reads must not go on without them
    std::mutex mutex;  // one writer at a time inside the process
};

void expect_store(const fs::path& file) {
    if (fs::exists(file)) return;
    throw std::invalid_argument(file.string() + ": there is no study here; make one with: morphodesic run FOLDER");
}

ResultStore::ResultStore(fs::path file, Access access) {
    if (access != Access::write) expect_store(file);
    refuse_lost_store(file);
    impl_ = std::make_unique<Impl>(std::move(file), access);
    impl_->open(access);
}
ResultStore::~ResultStore() = default;

const fs::path& ResultStore::file() const {
    return impl_->database.file();
}

std::optional<std::string> ResultStore::fact(std::string_view key) const {
    Statement s = impl_->database.prepare(
        "SELECT value, (SELECT value FROM study WHERE key = 'seal of ' || ?1) FROM study WHERE key = ?1");
    if (!s.bind(1, key).step()) return std::nullopt;
    std::string value = s.text(0);
    if (s.is_null(1) || s.text(1) == digest(value)) return value;
    if (impl_->repairs) return std::nullopt;
    throw StoreError(file(), "what it says of \"" + std::string(key) +
                                 "\" is damaged; give the command that made the study again (morphodesic run FOLDER)");
}

void ResultStore::set_fact(std::string_view key, std::string_view value) {
    const std::scoped_lock lock(impl_->mutex);
    impl_->set_fact(key, value);
}

std::vector<StoredShape> ResultStore::shapes() const {
    Statement s = impl_->database.prepare(
        "SELECT name, path, label, dimension, file_digest, reading, placing, extent_radius, content_digest, volume, "
        "scale, notes, problem, " +
        std::string(impl_->has_fullness() ? fullness_column : "NULL") + " FROM shapes ORDER BY name");
    std::vector<StoredShape> shapes;
    while (s.step()) {
        StoredShape shape{s.text(0), s.text(1),   s.text(2),    static_cast<int>(s.integer(3)),
                          s.text(4), s.text(5),   s.text(6),    s.number(7),
                          s.text(8), s.number(9), s.number(10), s.is_null(13) ? 0.0 : s.number(13),
                          {},        s.text(12)};
        const std::size_t space = shape.placing.find(' ');
        const std::string seal = space == std::string::npos ? "" : shape.placing.substr(space + 1);
        shape.placing.resize(std::min(space, shape.placing.size()));
        const std::string notes = s.text(11);
        if (seal == shape_seal(shape, notes) || seal == shape_seal(shape, notes, false)) {
            for (const json& note : json::parse(notes)) shape.notes.push_back(note.get<std::string>());
        } else {
            shape.damaged = true;
            shape.reading.clear();
            shape.placing.clear();
            shape.content_digest.clear();
            shape.problem = file().string() + ": what the store says of " + shape.name +
                            " is damaged; it is left out until the file is read again: give the command that made the "
                            "study again (morphodesic run FOLDER, or morphodesic ingest FOLDER)";
        }
        shapes.push_back(std::move(shape));
    }
    return shapes;
}

void ResultStore::put_shape(const StoredShape& shape) {
    const std::scoped_lock lock(impl_->mutex);
    Statement s =
        impl_->database.prepare("INSERT OR REPLACE INTO shapes VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    const std::string notes = json(shape.notes).dump(-1, ' ', false, json::error_handler_t::replace);
    const std::string placing = shape.placing + " " + shape_seal(shape, notes);
    s.bind(1, shape.name).bind(2, shape.path).bind(3, shape.label).bind(4, shape.dimension).bind(5, shape.file_digest);
    s.bind(6, shape.reading).bind(7, placing).bind(8, shape.extent_radius).bind(9, shape.content_digest);
    s.bind(10, shape.volume).bind(11, shape.scale);
    s.bind(12, notes).bind(13, shape.problem).bind(14, shape.fullness).run();
}

void ResultStore::remove_shapes(const std::vector<std::string>& names) {
    const std::scoped_lock lock(impl_->mutex);
    Transaction transaction(impl_->database);
    Statement s = impl_->database.prepare("DELETE FROM shapes WHERE name = ?");
    for (const std::string& name : names) s.bind(1, name).run();
    impl_->set_fact(shape_count, std::to_string(impl_->shapes_there()));
    transaction.commit();
}

void ResultStore::seal_shape_count() {
    const std::scoped_lock lock(impl_->mutex);
    impl_->set_fact(shape_count, std::to_string(impl_->shapes_there()));
}

long ResultStore::lost_shapes() const {
    const auto sealed = fact(shape_count);
    return sealed ? std::max(0L, std::stol(*sealed) - impl_->shapes_there()) : 0L;
}

template <int Dim>
void ResultStore::put_level_set(std::string_view digest, const LevelSet<Dim>& level_set, const ScalarField<Dim>& mask) {
    const std::string u = compress(level_set.values), chi = mask.values.empty() ? "" : compress(mask.values);
    const std::scoped_lock lock(impl_->mutex);
    Statement s = impl_->database.prepare("INSERT OR REPLACE INTO level_sets VALUES(?, ?, ?, ?, ?, ?)");
    s.bind(1, digest).bind(2, Dim).bind(3, level_set.grid.level()).bind_blob(4, u).bind_blob(5, chi);
    s.bind(6, pipeline::digest(u + chi)).run();
}

template <int Dim>
LevelSet<Dim> ResultStore::level_set(std::string_view digest, ScalarField<Dim>* mask) const {
    Statement s =
        impl_->database.prepare("SELECT dimension, level, u, mask, checksum FROM level_sets WHERE digest = ?");
    const char* advice =
        "; give the command that made the study again (morphodesic run FOLDER): it reads the file anew";
    if (!s.bind(1, digest).step()) {
        throw StoreError(file(), "the level set of a shape is missing (" + std::string(digest) + ")" + advice);
    }
    const std::string u = s.blob(2), chi = s.blob(3);
    LevelSet<Dim> result;
    if (s.integer(0) == Dim && pipeline::digest(u + chi) == s.text(4)) {
        result.grid = DyadicGrid<Dim>(static_cast<int>(s.integer(1)));
        result.values = uncompress(u, result.grid.node_count());
        if (mask) {
            *mask = {};
            mask->grid = result.grid;
            if (!chi.empty()) mask->values = uncompress(chi, result.grid.node_count());
        }
    }
    if (result.values.empty()) {
        throw StoreError(file(), "the level set of a shape is damaged (" + std::string(digest) + ")" + advice);
    }
    return result;
}

int ResultStore::level_of(std::string_view digest) const {
    Statement s = impl_->database.prepare("SELECT level FROM level_sets WHERE digest = ?");
    return s.bind(1, digest).step() ? static_cast<int>(s.integer(0)) : 0;
}

std::set<std::string> ResultStore::masked_level_sets() const {
    Statement s = impl_->database.prepare("SELECT digest FROM level_sets WHERE length(mask) > 0");
    std::set<std::string> digests;
    while (s.step()) digests.insert(s.text(0));
    return digests;
}

void ResultStore::remove_unused_level_sets() {
    const std::scoped_lock lock(impl_->mutex);
    impl_->database.execute("DELETE FROM level_sets WHERE digest NOT IN (SELECT content_digest FROM shapes)");
}

void ResultStore::put_settings(std::string_view hash, std::string_view text) {
    const std::scoped_lock lock(impl_->mutex);
    Statement s = impl_->database.prepare("INSERT OR IGNORE INTO settings VALUES(?, ?)");
    s.bind(1, hash).bind(2, text).run();
}

std::optional<std::string> ResultStore::settings(std::string_view hash) const {
    Statement s = impl_->database.prepare("SELECT text FROM settings WHERE hash = ?");
    return s.bind(1, hash).step() ? std::optional(s.text(0)) : std::nullopt;
}

void ResultStore::put_geodesic(const StoredGeodesic& g) {
    const std::scoped_lock lock(impl_->mutex);
    impl_->put_geodesic(g);
}

void ResultStore::put_geodesics(const std::vector<StoredGeodesic>& geodesics) {
    const std::scoped_lock lock(impl_->mutex);
    Transaction transaction(impl_->database);
    for (const StoredGeodesic& g : geodesics) impl_->put_geodesic(g);
    transaction.commit();
}

std::optional<StoredGeodesic> ResultStore::geodesic(std::string_view a, std::string_view b,
                                                    std::string_view settings_hash) const {
    Statement s = impl_->database.prepare("SELECT * FROM geodesics WHERE settings = ? AND a = ? AND b = ?");
    if (!s.bind(1, settings_hash).bind(2, a).bind(3, b).step()) return std::nullopt;
    auto [row, is_sound] = impl_->row(s);
    if (!is_sound) return std::nullopt;
    return row;
}

std::vector<StoredGeodesic> ResultStore::geodesics(std::string_view settings_hash, const OnDamage& on_damage) const {
    Statement s = impl_->database.prepare("SELECT * FROM geodesics WHERE settings = ? ORDER BY a, b");
    s.bind(1, settings_hash);
    std::vector<StoredGeodesic> rows;
    while (s.step()) {
        auto [row, is_sound] = impl_->row(s);
        if (is_sound) {
            rows.push_back(std::move(row));
        } else if (on_damage) {
            on_damage(row.a, row.b);
        }
    }
    return rows;
}

std::set<std::pair<std::string, std::string>> ResultStore::stored_pairs(std::string_view settings_hash,
                                                                        const OnDamage& on_damage) const {
    std::set<std::pair<std::string, std::string>> keys;
    for (StoredGeodesic& g : geodesics(settings_hash, on_damage)) keys.emplace(std::move(g.a), std::move(g.b));
    return keys;
}

long ResultStore::remove_failures(std::string_view settings_hash) {
    std::vector<std::pair<std::string, std::string>> failed;
    for (const StoredGeodesic& g : geodesics(settings_hash)) {
        if (!g.problem().empty()) failed.emplace_back(g.a, g.b);
    }
    const std::scoped_lock lock(impl_->mutex);
    Transaction transaction(impl_->database);
    Statement s = impl_->database.prepare("DELETE FROM geodesics WHERE settings = ? AND a = ? AND b = ?");
    for (const auto& [a, b] : failed) s.bind(1, settings_hash).bind(2, a).bind(3, b).run();
    transaction.commit();
    return static_cast<long>(failed.size());
}

void ResultStore::finish_as_one_file() {
    const std::scoped_lock lock(impl_->mutex);
    impl_->database.execute("PRAGMA journal_mode = DELETE");
}

std::optional<std::string> ResultStore::picture(std::string_view key) const {
    Statement s = impl_->database.prepare("SELECT bytes FROM pictures WHERE key = ?");
    if (!s.bind(1, key).step()) return std::nullopt;
    std::string bytes = s.blob(0);
    const std::size_t seal = digest("").size();  // behind the picture; one that is damaged is drawn again
    if (bytes.size() < seal) return std::nullopt;
    const std::string found = bytes.substr(bytes.size() - seal);
    bytes.resize(bytes.size() - seal);
    return found == digest(bytes) ? std::optional(std::move(bytes)) : std::nullopt;
}

void ResultStore::put_picture(std::string_view key, std::string_view bytes) {
    const std::scoped_lock lock(impl_->mutex);
    Statement s = impl_->database.prepare("INSERT OR REPLACE INTO pictures VALUES(?, ?)");
    s.bind(1, key).bind_blob(2, std::string(bytes) + digest(bytes)).run();
}

void ResultStore::remove_pictures(std::string_view beginning, std::string_view kept) {
    const std::scoped_lock lock(impl_->mutex);
    Statement s = impl_->database.prepare("DELETE FROM pictures WHERE substr(key, 1, length(?1)) = ?1 AND key != ?2");
    s.bind(1, beginning).bind(2, kept).run();
}

template void ResultStore::put_level_set<2>(std::string_view, const LevelSet<2>&, const ScalarField<2>&);
template void ResultStore::put_level_set<3>(std::string_view, const LevelSet<3>&, const ScalarField<3>&);
template LevelSet<2> ResultStore::level_set<2>(std::string_view, ScalarField<2>*) const;
template LevelSet<3> ResultStore::level_set<3>(std::string_view, ScalarField<3>*) const;

}  // namespace morphodesic::pipeline
