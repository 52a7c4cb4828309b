#include "tests/unit/recording/failing_disk.h"

#include <sqlite3.h>

#include <atomic>
#include <utility>

namespace evod::recording {
namespace {

std::atomic<std::uint64_t> operations_left = 0;
std::atomic<bool> failed = false;
std::atomic<Failure> how_to_fail = Failure::InputOutput;
std::atomic<std::uint64_t> operations_to_call = 0;
std::function<void()> to_call; // set while operations_to_call is 0

/// Whether the present operation is to fail.
bool fails_now() {
    if (operations_to_call.load() != 0 && operations_to_call.fetch_sub(1) == 1) {
        to_call();
    }
    if (failed && how_to_fail.load() == Failure::Gone) {
        return true;
    }
    if (operations_left.load() == 0 || operations_left.fetch_sub(1) != 1) {
        return false;
    }
    failed = true;
    return true;
}

int code() {
    return how_to_fail.load() == Failure::Full ? SQLITE_FULL : SQLITE_IOERR_WRITE;
}

/// A file of this disk; the real file follows it in memory.
struct File {
    sqlite3_file base;
};

sqlite3_file* real(sqlite3_file* file) {
    return reinterpret_cast<sqlite3_file*>(reinterpret_cast<File*>(file) + 1);
}
const sqlite3_io_methods& methods(sqlite3_file* file) {
    return *real(file)->pMethods;
}

int write(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 offset) {
    if (fails_now()) {
        if (how_to_fail.load() == Failure::Torn) {
            methods(file).xWrite(real(file), bytes, count / 2, offset);
        }
        return code();
    }
    return methods(file).xWrite(real(file), bytes, count, offset);
}
int sync(sqlite3_file* file, int flags) {
    return fails_now() ? SQLITE_IOERR_FSYNC : methods(file).xSync(real(file), flags);
}
int truncate(sqlite3_file* file, sqlite3_int64 size) {
    return fails_now() ? SQLITE_IOERR_TRUNCATE : methods(file).xTruncate(real(file), size);
}

// Operations that are passed on unchanged.
int close(sqlite3_file* file) {
    return methods(file).xClose(real(file));
}
int read(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
    return methods(file).xRead(real(file), bytes, count, offset);
}
int file_size(sqlite3_file* file, sqlite3_int64* size) {
    return methods(file).xFileSize(real(file), size);
}
int lock(sqlite3_file* file, int level) {
    return methods(file).xLock(real(file), level);
}
int unlock(sqlite3_file* file, int level) {
    return methods(file).xUnlock(real(file), level);
}
int check_reserved_lock(sqlite3_file* file, int* reserved) {
    return methods(file).xCheckReservedLock(real(file), reserved);
}
int file_control(sqlite3_file* file, int operation, void* argument) {
    return methods(file).xFileControl(real(file), operation, argument);
}
int sector_size(sqlite3_file* file) {
    return methods(file).xSectorSize(real(file));
}
int device_characteristics(sqlite3_file* file) {
    return methods(file).xDeviceCharacteristics(real(file));
}
int shared_map(sqlite3_file* file, int page, int size, int extend, void volatile** memory) {
    return methods(file).xShmMap(real(file), page, size, extend, memory);
}
int shared_lock(sqlite3_file* file, int offset, int count, int flags) {
    return methods(file).xShmLock(real(file), offset, count, flags);
}
void shared_barrier(sqlite3_file* file) {
    methods(file).xShmBarrier(real(file));
}
int shared_unmap(sqlite3_file* file, int remove) {
    return methods(file).xShmUnmap(real(file), remove);
}

constexpr sqlite3_io_methods passing_on = {2,
                                           close,
                                           read,
                                           write,
                                           truncate,
                                           sync,
                                           file_size,
                                           lock,
                                           unlock,
                                           check_reserved_lock,
                                           file_control,
                                           sector_size,
                                           device_characteristics,
                                           shared_map,
                                           shared_lock,
                                           shared_barrier,
                                           shared_unmap,
                                           nullptr,
                                           nullptr};

int open(sqlite3_vfs* disk, const char* name, sqlite3_file* file, int flags, int* flags_out) {
    (void)disk;
    sqlite3_vfs* usual = sqlite3_vfs_find(nullptr);
    file->pMethods = nullptr;
    const int opened = usual->xOpen(usual, name, real(file), flags, flags_out);
    if (opened == SQLITE_OK) {
        file->pMethods = &passing_on;
    }
    return opened;
}

} // namespace

const char* failing_disk() {
    static sqlite3_vfs disk = [] {
        sqlite3_vfs* usual = sqlite3_vfs_find(nullptr);
        sqlite3_vfs copy = *usual;
        copy.zName = "failing";
        copy.pNext = nullptr;
        copy.pAppData = usual->pAppData; // the usual functions below use it
        copy.szOsFile = static_cast<int>(sizeof(File)) + usual->szOsFile;
        copy.xOpen = open;
        return copy;
    }();
    static const int registered = sqlite3_vfs_register(&disk, 0);
    return registered == SQLITE_OK ? disk.zName : nullptr;
}

void fail_operation(std::uint64_t count, Failure how) {
    how_to_fail = how;
    failed = false;
    operations_left = count;
}

void call_before_operation(std::uint64_t count, std::function<void()> call) {
    to_call = std::move(call);
    operations_to_call = count;
}

bool has_failed() {
    return failed;
}

} // namespace evod::recording
