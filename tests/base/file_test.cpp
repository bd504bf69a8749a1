// Files: clear errors, and an old file that survives every failed write.
#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

namespace surefoot {
namespace {

namespace fs = std::filesystem;

class FileTest : public ::testing::Test {
protected:
    [[nodiscard]] std::string in(const std::string& name) const { return folder_ / name; }
    [[nodiscard]] std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator{}));
    }
    test::TemporaryFolder folder_;
};

TEST_F(FileTest, ErrorReadsAsPlaceWhatRemedy) {
    EXPECT_EQ((Error{"a.csv:3", "Row 3 has two columns", "Add the third one"}).text(),
              "a.csv:3: Row 3 has two columns. Add the third one.");
    EXPECT_EQ((Error{"a", "b", ""}).text(), "a: b.");
    EXPECT_EQ((Error{"", "b", ""}).text(), "b.");
    EXPECT_EQ((Error{"", "b", "Did you mean c?"}).text(), "b. Did you mean c?");
}

TEST_F(FileTest, MissingFileIsNamed) {
    const auto read = read_file(in("none"));
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().text().find(in("none")), std::string::npos);
    EXPECT_NE(read.error().text().find("No such file"), std::string::npos);
}

TEST_F(FileTest, FolderIsRefused) {
    const auto read = read_file(folder_.path());
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().what.find("folder"), std::string::npos);
}

TEST_F(FileTest, DeviceWithoutAnEndIsRefused) {
    const auto zeros = read_file("/dev/zero");
    ASSERT_FALSE(zeros.ok());
    EXPECT_NE(zeros.error().text().find("device"), std::string::npos);
}

TEST_F(FileTest, EmptyFileIsNoError) {
    ASSERT_TRUE(write_text(in("empty"), "").ok());
    const auto read = read_file(in("empty"));
    ASSERT_TRUE(read.ok());
    EXPECT_TRUE(read->empty());
}

TEST_F(FileTest, LimitIsHeld) {
    ASSERT_TRUE(write_text(in("ten"), "0123456789").ok());
    EXPECT_TRUE(read_text(in("ten"), 10).ok());
    EXPECT_FALSE(read_text(in("ten"), 9).ok());
}

TEST_F(FileTest, LimitIsHeldWhereTheSizeIsUnknown) {
    const auto whole = read_text("/proc/self/status");  // says size 0
    ASSERT_TRUE(whole.ok());
    EXPECT_GT(whole->size(), 100U);
    EXPECT_FALSE(read_text("/proc/self/status", 100).ok());
}

TEST_F(FileTest, WithoutCommitTheOldFileStaysAndNoTemporaryIsLeft) {
    ASSERT_TRUE(write_text(in("f"), "old").ok());
    {
        auto file = AtomicFile::create(in("f"));
        ASSERT_TRUE(file.ok());
        ASSERT_TRUE(file->write("new").ok());
    }
    EXPECT_EQ(*read_text(in("f")), "old");
    EXPECT_EQ(files(), 1U);
}

TEST_F(FileTest, CommitReplacesAndKeepsTheMode) {
    ASSERT_TRUE(write_text(in("f"), "old").ok());
    ASSERT_EQ(::chmod(in("f").c_str(), 0640), 0);
    ASSERT_TRUE(write_text(in("f"), "new").ok());
    EXPECT_EQ(*read_text(in("f")), "new");
    EXPECT_EQ(files(), 1U);
    struct stat info {};
    ASSERT_EQ(::stat(in("f").c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777U, 0640U);
}

TEST_F(FileTest, WriteAtFillsEarlierBytes) {
    auto file = AtomicFile::create(in("f"));
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(file->write("....tail").ok());
    ASSERT_TRUE(file->write_at(0, std::as_bytes(std::span("head", 4))).ok());
    ASSERT_TRUE(file->commit().ok());
    EXPECT_EQ(*read_text(in("f")), "headtail");
}

TEST_F(FileTest, MovedFileStillCommitsAndTheSourceRefuses) {
    auto first = AtomicFile::create(in("f"));
    ASSERT_TRUE(first.ok());
    AtomicFile second = std::move(*first);
    EXPECT_FALSE(first->write("x").ok());  // NOLINT(bugprone-use-after-move): this is the case tested
    ASSERT_TRUE(second.write("kept").ok());
    ASSERT_TRUE(second.commit().ok());
    EXPECT_EQ(*read_text(in("f")), "kept");
}

TEST_F(FileTest, LinkIsWrittenThrough) {
    ASSERT_TRUE(write_text(in("real"), "old").ok());
    fs::create_symlink("real", in("link"));
    ASSERT_TRUE(write_text(in("link"), "new").ok());
    EXPECT_TRUE(fs::is_symlink(in("link")));
    EXPECT_EQ(*read_text(in("real")), "new");
}

TEST_F(FileTest, UnwritablePlacesAreNamed) {
    EXPECT_FALSE(AtomicFile::create("").ok());
    EXPECT_FALSE(AtomicFile::create(folder_.path()).ok());
    EXPECT_FALSE(AtomicFile::create("/dev/null").ok());
    const auto nowhere = AtomicFile::create(in("no/such/f"));
    ASSERT_FALSE(nowhere.ok());
    EXPECT_NE(nowhere.error().text().find(in("no/such")), std::string::npos);
}

TEST_F(FileTest, ProbingReportsWhatWritingWouldAndLeavesNothing) {
    const std::string good = folder_ / "new";
    EXPECT_TRUE(probe_writable(good).ok());
    EXPECT_FALSE(probe_writable(folder_ / "no/such/file").ok());
    EXPECT_TRUE(probe_writable(folder_ / "no/such/file", true).ok());
    EXPECT_TRUE(fs::is_empty(folder_.path()));
    ASSERT_TRUE(write_text(good, "kept").ok());
    EXPECT_TRUE(probe_writable(good).ok());
    const auto below = probe_writable(folder_ / "new/file", true);
    ASSERT_FALSE(below.ok());
    EXPECT_NE(below.error().text().find("not a folder"), std::string::npos);
    EXPECT_FALSE(probe_writable(folder_.path()).ok());
    EXPECT_EQ(*read_text(good), "kept");
    fs::remove(good);
    EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(FileTest, FilesThatBelongTogetherTakeTheirPlacesTogether) {
    const std::string set = in("set");
    const auto write = [&](std::string_view first, std::string_view second) -> Result<void> {
        auto files = FileSet::create(set);
        if (!files) return files.error();
        if (auto ok = files->add("a", first); !ok) return ok;
        if (auto ok = files->add("b", second); !ok) return ok;
        return files->commit();
    };
    ASSERT_TRUE(write("old a", "old b").ok());
    rlimit before{};
    const auto handler = ::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    rlimit small = before;
    small.rlim_cur = 16;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const auto full = write("new a", "new b, and longer than the disk holds");
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    ::signal(SIGXFSZ, handler);
    ASSERT_FALSE(full.ok());
    EXPECT_NE(full.error().text().find("set/b"), std::string::npos);
    EXPECT_EQ(*read_text(in("set/a")), "old a");
    EXPECT_EQ(*read_text(in("set/b")), "old b");
    EXPECT_EQ(std::distance(fs::directory_iterator(set), fs::directory_iterator{}), 2) << "no temporary is left";
    ASSERT_TRUE(write("new a", "new b").ok());
    EXPECT_EQ(*read_text(in("set/a")) + *read_text(in("set/b")), "new anew b");
    {  // a place that is taken away at the last moment keeps none of the others back
        auto files = FileSet::create(set);
        ASSERT_TRUE(files->add("a", "newer a").ok() && files->add("b", "newer b").ok() && files->add("c", "newer c").ok());
        fs::remove(in("set/b"));
        fs::create_directory(in("set/b"));
        const auto done = files->commit();
        ASSERT_FALSE(done.ok());
        EXPECT_NE(done.error().text().find("set/b"), std::string::npos);
        EXPECT_EQ(*read_text(in("set/a")) + *read_text(in("set/c")), "newer anewer c");
        EXPECT_EQ(std::distance(fs::directory_iterator(set), fs::directory_iterator{}), 3) << "no temporary is left";
        fs::remove(in("set/b"));
    }
    EXPECT_TRUE(FileSet::probe(in("other"), {"a", "b"}).ok());
    EXPECT_FALSE(FileSet::probe(in("set/a"), {"b"}).ok());
}

TEST_F(FileTest, ReadOnlyFolderIsRefused) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    fs::permissions(folder_.path(), fs::perms::owner_read | fs::perms::owner_exec);
    const auto file = AtomicFile::create(in("f"));
    ASSERT_FALSE(file.ok());
    EXPECT_FALSE(file.error().remedy.empty());
}

}  // namespace
}  // namespace surefoot
