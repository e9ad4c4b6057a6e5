"""The leaderboard's page: ``page.write_site`` makes a folder of boards that opens from a disk."""
