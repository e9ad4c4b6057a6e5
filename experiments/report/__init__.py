"""The leaderboard's page: ``page.write_page`` makes one self-contained HTML file of a board."""
